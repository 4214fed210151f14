#include "vasohex/core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>

namespace vasohex {

void parallel_for(const Run& run, std::size_t n, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t chunks = (n + grain - 1) / grain;
  const auto chunk = [&](std::size_t c) { body(c * grain, std::min(n, (c + 1) * grain)); };
  if (run.threads == 1 || chunks <= 1) {
    for (std::size_t c = 0; c < chunks; ++c) {
      chunk(c);
    }
    return;
  }
  // more threads than cores only on demand; oneTBB would print a warning
  std::optional<tbb::global_control> allowed;
  if (run.threads > tbb::info::default_concurrency()) {
    allowed.emplace(tbb::global_control::max_allowed_parallelism, run.threads);
  }
  tbb::task_arena arena(run.threads > 0 ? run.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, chunks, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t c = range.begin(); c != range.end(); ++c) {
            chunk(c);
          }
        },
        tbb::simple_partitioner());
  });
}

}  // namespace vasohex
