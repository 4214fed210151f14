#pragma once
/// \file Internal to quality/: checks of the arguments that all measures share, and their loop over the elements.

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vasohex/core/error.h"
#include "vasohex/core/parallel.h"
#include "vasohex/core/vec3.h"
#include "vasohex/quality/jacobian_kernel.h"

namespace vasohex {

inline std::size_t nodes_per_hex(int order) {
  const std::size_t n = order + 1;
  return n * n * n;
}

/// Number of elements; Error bad_input if the arguments do not describe elements.
inline std::size_t checked_element_count(int order, std::span<const Vec3> nodes, std::span<const int> elements) {
  if (order < 1 || order > kernel::kMaxOrder) {
    throw Error(ErrorCode::bad_input, "order " + std::to_string(order) + ": quality is defined for orders 1 to " +
                                          std::to_string(kernel::kMaxOrder));
  }
  const std::size_t per_element = nodes_per_hex(order);
  if (elements.size() % per_element != 0) {
    throw Error(ErrorCode::bad_input, std::to_string(elements.size()) + " node indices: must be a multiple of the " +
                                          std::to_string(per_element) + " nodes of an element of order " +
                                          std::to_string(order));
  }
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (elements[i] < 0 || static_cast<std::size_t>(elements[i]) >= nodes.size()) {
      throw Error(ErrorCode::bad_input, "element " + std::to_string(i / per_element) + " names node " +
                                            std::to_string(elements[i]) + ", there are " +
                                            std::to_string(nodes.size()));
    }
  }
  return elements.size() / per_element;
}

/// parallel_for over the elements, in parts after which progress is told.
inline void for_elements(const Run& run, std::string_view stage, std::size_t count, std::size_t grain,
                         const std::function<void(std::size_t begin, std::size_t end)>& body) {
  const std::size_t part = 1 << 16;
  for (std::size_t begin = 0; begin < count; begin += part) {
    run.progress(stage, static_cast<double>(begin) / static_cast<double>(count));
    parallel_for(run, std::min(part, count - begin), grain,
                 [&](std::size_t first, std::size_t last) { body(begin + first, begin + last); });
  }
  run.progress(stage, 1);
}

/// Memory for a kernel.
class KernelScratch {
 public:
  explicit KernelScratch(unsigned long bytes) : lines_(bytes / sizeof(Line) + 1) {}
  void* get() { return lines_.data(); }

 private:
  struct alignas(64) Line {
    double values[8];
  };
  std::vector<Line> lines_;
};

}  // namespace vasohex
