#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "vasohex/core/error.h"
#include "vasohex/core/text_lines.h"
#include "vasohex/surface/read_surface.h"

namespace vasohex {
namespace {

enum class Number { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Number type = Number::float32;
  bool list = false;
  Number count_type = Number::uint8;
};

struct Element {
  std::string name;
  long long count = 0;
  std::vector<Property> properties;
};

enum class Coding { ascii, little, big };

struct Header {
  Coding coding = Coding::ascii;
  std::vector<Element> elements;
  std::size_t size = 0;  ///< bytes
  int lines = 0;
};

Number number_type(const TextLines& lines, std::size_t w) {
  constexpr std::array<std::array<const char*, 2>, 8> names{{{"char", "int8"},
                                                             {"uchar", "uint8"},
                                                             {"short", "int16"},
                                                             {"ushort", "uint16"},
                                                             {"int", "int32"},
                                                             {"uint", "uint32"},
                                                             {"float", "float32"},
                                                             {"double", "float64"}}};
  const std::string_view word = w < lines.words().size() ? lines.words()[w] : std::string_view();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (word == names[i][0] || word == names[i][1]) {
      return static_cast<Number>(i);
    }
  }
  lines.fail("'" + std::string(word) +
             "' is not a type of PLY (char, uchar, short, ushort, int, uint, float, double)");
}

Header read_header(std::string_view bytes) {
  Header header;
  TextLines lines(bytes);
  if (!lines.next() || lines.words()[0] != "ply") {
    throw Error(ErrorCode::bad_input, "does not start with ply");
  }
  bool has_format = false;
  while (lines.next()) {
    const auto& words = lines.words();
    const auto word = [&](std::size_t w) { return w < words.size() ? words[w] : std::string_view(); };
    if (words[0] == "format") {
      has_format = true;
      if (word(1) == "binary_little_endian" || word(1) == "binary_big_endian") {
        header.coding = word(1) == "binary_big_endian" ? Coding::big : Coding::little;
      } else if (word(1) != "ascii") {
        lines.fail("format '" + std::string(word(1)) + "', must be ascii, binary_little_endian or binary_big_endian");
      }
    } else if (words[0] == "element") {
      header.elements.push_back({std::string(word(1)), lines.integer(2, "the count of elements"), {}});
      if (header.elements.back().count < 0) {
        lines.fail("the count of elements is " + std::string(word(2)) + ", must be >= 0");
      }
    } else if (words[0] == "property") {
      if (header.elements.empty()) {
        lines.fail("a property before the first element");
      }
      Property property;
      property.list = word(1) == "list";
      property.count_type = property.list ? number_type(lines, 2) : Number::uint8;
      property.type = number_type(lines, property.list ? 3 : 1);
      property.name = word(property.list ? 4 : 2);
      header.elements.back().properties.push_back(property);
    } else if (words[0] == "end_header") {
      if (!has_format) {
        lines.fail("the header has no format");
      }
      header.size = lines.end();
      header.lines = lines.number();
      return header;
    } else if (words[0] != "comment" && words[0] != "obj_info") {
      lines.fail("'" + std::string(words[0]) + "' is none of the words of a PLY header");
    }
  }
  lines.fail("the header does not end with end_header");
}

/// The numbers of the elements, one after the other.
class Numbers {
 public:
  Numbers(std::string_view bytes, const Header& header)
      : bytes_(bytes.substr(header.size)), coding_(header.coding), lines_(bytes_), first_line_(header.lines) {}

  void begin_element(const Element& element, long long i) {
    element_ = &element;
    index_ = i;
    if (coding_ == Coding::ascii) {
      if (!lines_.next()) {
        fail("the file ends here");
      }
      word_ = 0;
    }
  }

  double next(Number type, const char* what) {
    double value = 0;
    if (coding_ == Coding::ascii) {
      try {
        value = lines_.real(word_++, what);
      } catch (const Error&) {
        fail(std::string(what) + (word_ > lines_.words().size() ? " is missing"
                                                                : " is '" + std::string(lines_.words()[word_ - 1]) +
                                                                      "', must be a finite number"));
      }
    } else {
      value = binary(type);
      if (!std::isfinite(value)) {
        fail(std::string(what) + " is not a finite number");
      }
    }
    return value;
  }

  [[noreturn]] void fail(const std::string& what) const {
    const std::string line =
        coding_ == Coding::ascii ? "line " + std::to_string(first_line_ + lines_.number()) + ": " : "";
    throw Error(ErrorCode::bad_input, line + element_->name + " " + std::to_string(index_) + " of " +
                                          std::to_string(element_->count) + ", counted from 0: " + what);
  }

 private:
  double binary(Number type) {
    constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
    const std::size_t size = sizes[static_cast<std::size_t>(type)];
    if (at_ + size > bytes_.size()) {
      fail("the file ends here");
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t place = coding_ == Coding::big ? i : size - 1 - i;
      bits = bits << 8 | static_cast<unsigned char>(bytes_[at_ + place]);
    }
    at_ += size;
    switch (type) {
      case Number::int8:
        return static_cast<std::int8_t>(bits);
      case Number::int16:
        return static_cast<std::int16_t>(bits);
      case Number::int32:
        return static_cast<std::int32_t>(bits);
      case Number::float32:
        return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
      case Number::float64:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }

  std::string_view bytes_;
  Coding coding_;
  TextLines lines_;
  int first_line_ = 0;
  std::size_t word_ = 0, at_ = 0;
  const Element* element_ = nullptr;
  long long index_ = 0;
};

}  // namespace

TriSurface parse_ply(std::string_view bytes) {
  const Header header = read_header(bytes);
  Numbers numbers(bytes, header);
  TriSurface surface;
  std::vector<long long> list;
  for (const Element& element : header.elements) {
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    for (long long i = 0; i < element.count && !element.properties.empty(); ++i) {
      numbers.begin_element(element, i);
      Vec3 point = Vec3::Constant(std::nan(""));
      std::vector<long long> corners;
      for (const Property& property : element.properties) {
        if (!property.list) {
          const double value = numbers.next(property.type, property.name.c_str());
          if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z') {
            point[property.name[0] - 'x'] = value;
          }
          continue;
        }
        const double count = numbers.next(property.count_type, "the count of a list");
        list.clear();
        for (double c = 0; c < count; ++c) {
          list.push_back(static_cast<long long>(numbers.next(property.type, "a number of a list")));
        }
        if (property.name == "vertex_indices" || property.name == "vertex_index") {
          corners = list;
        }
      }
      if (is_vertex) {
        if (!point.allFinite()) {
          numbers.fail("needs the properties x, y and z");
        }
        surface.points.push_back(point);
      } else if (is_face) {
        if (const std::string wrong = add_face(surface, corners); !wrong.empty()) {
          numbers.fail(wrong);
        }
      }
    }
  }
  return surface;
}

}  // namespace vasohex
