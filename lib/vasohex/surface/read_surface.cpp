#include "vasohex/surface/read_surface.h"

#include <algorithm>

#include "vasohex/core/error.h"
#include "vasohex/core/text_lines.h"

namespace vasohex {

std::string add_face(TriSurface& surface, const std::vector<long long>& corners) {
  if (corners.size() < 3 || corners.size() > 4) {
    return "a face with " + std::to_string(corners.size()) + " corners; must be a triangle or a quadrilateral";
  }
  for (const long long c : corners) {
    if (c < 0 || c >= static_cast<long long>(surface.points.size())) {
      return "a face has point " + std::to_string(c) + ", counted from 0, but there are " +
             std::to_string(surface.points.size()) + " points";
    }
  }
  const auto corner = [&](std::size_t i) { return static_cast<int>(corners[i]); };
  if (corners.size() == 3) {
    surface.triangles.push_back({corner(0), corner(1), corner(2)});
    return {};
  }
  const auto length = [&](std::size_t a, std::size_t b) {
    return (surface.points[corner(a)] - surface.points[corner(b)]).squaredNorm();
  };
  const std::size_t first = length(0, 2) <= length(1, 3) ? 0 : 1;
  surface.triangles.push_back({corner(first), corner(first + 1), corner(first + 2)});
  surface.triangles.push_back({corner(first), corner(first + 2), corner((first + 3) % 4)});
  return {};
}

TriSurface parse_obj(std::string_view text) {
  TriSurface surface;
  TextLines lines(text, '#');
  std::vector<long long> corners;
  while (lines.next()) {
    const auto& words = lines.words();
    if (words[0] == "v") {
      surface.points.emplace_back(lines.real(1, "x"), lines.real(2, "y"), lines.real(3, "z"));
    } else if (words[0] == "f") {
      corners.clear();
      for (std::size_t w = 1; w < words.size(); ++w) {
        // point/texture/normal; negative counts back from the last point
        TextLines index(words[w].substr(0, words[w].find('/')));
        if (!index.next()) {
          lines.fail("corner '" + std::string(words[w]) + "' has no point");
        }
        const long long i = with_context("line " + std::to_string(lines.number()),
                                         [&] { return index.integer(0, "the index of a corner"); });
        if (i == 0) {
          lines.fail("a face has point 0; OBJ counts from 1");
        }
        corners.push_back(i > 0 ? i - 1 : i + static_cast<long long>(surface.points.size()));
      }
      if (const std::string wrong = add_face(surface, corners); !wrong.empty()) {
        lines.fail(wrong);
      }
    }
  }
  return surface;
}

TriSurface parse_off(std::string_view text) {
  TriSurface surface;
  TextLines lines(text, '#');
  if (!lines.next() || !lines.words()[0].ends_with("OFF")) {
    throw Error(ErrorCode::bad_input, "does not start with OFF");
  }
  if (lines.words()[0] != "OFF" && lines.words()[0] != "NOFF" && lines.words()[0] != "COFF" &&
      lines.words()[0] != "CNOFF") {
    lines.fail("'" + std::string(lines.words()[0]) +
               "' is a kind that is not known; known are OFF, NOFF, COFF, CNOFF");
  }
  std::size_t w = 1;
  if (lines.words().size() == 1) {
    w = 0;
    if (!lines.next()) {
      lines.fail("the file ends before the counts of points and faces");
    }
  }
  const long long points = lines.integer(w, "the count of points"),
                  faces = lines.integer(w + 1, "the count of faces");
  const auto next = [&](long long i, long long count, const char* what) {
    if (!lines.next()) {
      lines.fail("the file ends after " + std::to_string(i) + " of " + std::to_string(count) + " " + what);
    }
  };
  for (long long i = 0; i < points; ++i) {
    next(i, points, "points");
    surface.points.emplace_back(lines.real(0, "x"), lines.real(1, "y"), lines.real(2, "z"));
  }
  for (long long i = 0; i < faces; ++i) {
    next(i, faces, "faces");
    const long long count = lines.integer(0, "the count of corners");
    std::vector<long long> corners;
    for (long long c = 0; c < std::min(count, 5LL); ++c) {
      corners.push_back(lines.integer(static_cast<std::size_t>(c) + 1, "the index of a corner"));
    }
    if (const std::string wrong = add_face(surface, corners); !wrong.empty()) {
      lines.fail(wrong);
    }
  }
  return surface;
}

TriSurface read_surface(const std::string& path) {
  return with_context("surface " + path, [&] {
    const std::string extension = lower_extension(path);
    TriSurface (*parse)(std::string_view) = extension == ".stl"   ? parse_stl
                                            : extension == ".ply" ? parse_ply
                                            : extension == ".obj" ? parse_obj
                                            : extension == ".off" ? parse_off
                                                                  : nullptr;
    if (parse == nullptr) {
      throw Error(ErrorCode::bad_input, "a surface cannot be read from the extension '" + extension +
                                            "'; known are .stl, .ply, .obj and .off");
    }
    const std::string bytes = file_bytes(path);
    if (bytes.empty()) {
      throw Error(ErrorCode::bad_input, "the file is empty; must hold triangles");
    }
    TriSurface surface = parse(bytes);
    if (surface.triangles.empty()) {
      throw Error(ErrorCode::bad_input, "no triangles; at least one is needed");
    }
    return surface;
  });
}

}  // namespace vasohex
