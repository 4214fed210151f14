#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <unordered_map>

#include "vasohex/core/error.h"
#include "vasohex/core/text_lines.h"
#include "vasohex/surface/read_surface.h"

namespace vasohex {
namespace {

/// Points with equal coordinates get one index, in the order in which they come.
class PointNumbers {
 public:
  explicit PointNumbers(std::vector<Vec3>& points) : points_(points) {}
  int operator()(const Vec3& point) {
    const Vec3 key = point + Vec3::Zero();  // -0 becomes 0
    const auto [entry, is_new] = number_.emplace(key, static_cast<int>(points_.size()));
    if (is_new) {
      points_.push_back(key);
    }
    return entry->second;
  }

 private:
  struct Hash {
    std::size_t operator()(const Vec3& p) const {
      std::uint64_t h = 0;
      for (int d = 0; d < 3; ++d) {
        h = (h ^ std::bit_cast<std::uint64_t>(p[d])) * 0x9E3779B97F4A7C15ull;
        h ^= h >> 29;
      }
      return h;
    }
  };
  std::vector<Vec3>& points_;
  std::unordered_map<Vec3, int, Hash> number_;
};

TriSurface parse_ascii(std::string_view text) {
  TriSurface surface;
  PointNumbers number(surface.points);
  TextLines lines(text);
  std::array<int, 3> corners{};
  int count = 0;
  bool inside = false, ended = false;
  while (lines.next()) {
    const std::string word = lower_case(lines.words()[0]);
    if (word == "facet") {
      if (inside) {
        lines.fail("a facet begins before the last one has ended");
      }
      inside = true;
      count = 0;
    } else if (word == "vertex") {
      const Vec3 point(lines.real(1, "x"), lines.real(2, "y"), lines.real(3, "z"));
      if (!inside || count == 3) {
        lines.fail(inside ? "a facet has more than 3 vertices" : "a vertex outside of a facet");
      }
      corners[count++] = number(point);
    } else if (word == "endfacet") {
      if (!inside || count != 3) {
        lines.fail("a facet has " + std::to_string(count) + " vertices, must have 3");
      }
      surface.triangles.push_back(corners);
      inside = false;
    } else if (word == "solid" || word == "endsolid") {
      ended = word == "endsolid";
    } else if (word != "outer" && word != "endloop") {
      lines.fail("'" + std::string(lines.words()[0]) + "' is none of the words of an STL file");
    }
  }
  if (inside || !ended) {
    lines.fail("the file ends " + std::string(inside ? "within a facet" : "without endsolid") + ", after " +
               std::to_string(surface.triangles.size()) + " triangles; it seems cut off");
  }
  return surface;
}

std::uint32_t little_endian(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) {
    value = value << 8 | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

constexpr std::size_t kHeader = 84, kRecord = 50;

TriSurface parse_binary(std::string_view bytes, std::size_t count) {
  const std::size_t there = (bytes.size() - kHeader) / kRecord;
  if (there < count) {
    throw Error(ErrorCode::bad_input, "cut off after triangle " + std::to_string(there) + " of the " +
                                          std::to_string(count) + " that the header of the binary STL names");
  }
  TriSurface surface;
  PointNumbers number(surface.points);
  surface.triangles.reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    const char* record = bytes.data() + kHeader + t * kRecord + 12;
    std::array<int, 3> corners{};
    for (int c = 0; c < 3; ++c) {
      Vec3 point;
      for (int d = 0; d < 3; ++d) {
        point[d] = std::bit_cast<float>(little_endian(record + 12 * c + 4 * d));
      }
      if (!point.allFinite()) {
        throw Error(ErrorCode::bad_input,
                    "triangle " + std::to_string(t) + ", counted from 0: a coordinate is not a finite number");
      }
      corners[c] = number(point);
    }
    surface.triangles.push_back(corners);
  }
  return surface;
}

}  // namespace

TriSurface parse_stl(std::string_view bytes) {
  // "solid" may start a binary header too: the size decides, then the text
  const std::size_t count = bytes.size() >= kHeader ? little_endian(bytes.data() + kHeader - 4) : 0;
  if (bytes.size() >= kHeader && bytes.size() == kHeader + kRecord * count) {
    return parse_binary(bytes, count);
  }
  TextLines lines(bytes.substr(0, 1000));
  if (lines.next() && lower_case(lines.words()[0]) == "solid" &&
      bytes.substr(0, 1000).find('\0') == std::string_view::npos) {
    return parse_ascii(bytes);
  }
  if (bytes.size() < kHeader) {
    throw Error(ErrorCode::bad_input,
                "neither an ASCII STL, which starts with solid, nor a binary one, whose header "
                "has 84 bytes");
  }
  return parse_binary(bytes, count);
}

}  // namespace vasohex
