#include <zlib.h>

#include <bit>
#include <charconv>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

#include "vasohex/core/error.h"
#include "vasohex/core/text_lines.h"
#include "vasohex/skeleton/read_skeleton.h"
#include "vtk/labels.h"

// VTK's reader of NRRD knows neither directions nor gzip. http://teem.sourceforge.net/nrrd/format.html

namespace vasohex {
namespace {

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::bad_input, what); }

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t\r");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

/// The fields of the header, and where the voxels begin.
struct Header {
  std::map<std::string, std::string> fields;
  std::size_t end = 0;

  const std::string& at(const std::string& name) const {
    const auto found = fields.find(name);
    if (found == fields.end()) {
      fail("the header has no field '" + name + "'");
    }
    return found->second;
  }
  std::string get(const std::string& name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? "" : found->second;
  }
};

Header parse_header(const std::string& text) {
  if (!text.starts_with("NRRD000")) {
    fail("not NRRD: it does not begin with NRRD000");
  }
  Header header;
  std::size_t begin = text.find('\n');
  while (true) {
    if (begin == std::string::npos) {
      fail("the header has no end (an empty line)");
    }
    ++begin;
    const std::size_t end = text.find('\n', begin);
    const std::string line = trimmed(text.substr(begin, end == std::string::npos ? end : end - begin));
    if (line.empty() && end != std::string::npos) {
      header.end = end + 1;
      return header;
    }
    const std::size_t colon = line.find(": ");
    if (!line.starts_with('#') && colon != std::string::npos && line.find(":=") > colon) {
      header.fields[lower_case(line.substr(0, colon))] = trimmed(line.substr(colon + 2));
    }
    begin = end;
  }
}

/// The numbers in a text, whatever brackets and commas are between them; `none` counts as three times NaN.
std::vector<double> numbers(std::string text, const std::string& field) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
  std::istringstream words(text);
  std::vector<double> result;
  for (std::string word; words >> word;) {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (word == "none") {
      result.insert(result.end(), 3, value);
      continue;
    }
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) {
      fail("field '" + field + "' has '" + word + "', must be numbers");
    }
    result.push_back(value);
  }
  return result;
}

VoxelType type_of(const std::string& name) {
  static const std::map<std::string, VoxelType> types = {
      {"signed char", VoxelType::int8},
      {"int8", VoxelType::int8},
      {"int8_t", VoxelType::int8},
      {"uchar", VoxelType::uint8},
      {"unsigned char", VoxelType::uint8},
      {"uint8", VoxelType::uint8},
      {"uint8_t", VoxelType::uint8},
      {"short", VoxelType::int16},
      {"short int", VoxelType::int16},
      {"signed short", VoxelType::int16},
      {"int16", VoxelType::int16},
      {"int16_t", VoxelType::int16},
      {"ushort", VoxelType::uint16},
      {"unsigned short", VoxelType::uint16},
      {"unsigned short int", VoxelType::uint16},
      {"uint16", VoxelType::uint16},
      {"uint16_t", VoxelType::uint16},
      {"int", VoxelType::int32},
      {"signed int", VoxelType::int32},
      {"int32", VoxelType::int32},
      {"int32_t", VoxelType::int32},
      {"uint", VoxelType::uint32},
      {"unsigned int", VoxelType::uint32},
      {"uint32", VoxelType::uint32},
      {"uint32_t", VoxelType::uint32},
      {"longlong", VoxelType::int64},
      {"long long", VoxelType::int64},
      {"int64", VoxelType::int64},
      {"int64_t", VoxelType::int64},
      {"ulonglong", VoxelType::uint64},
      {"unsigned long long", VoxelType::uint64},
      {"uint64", VoxelType::uint64},
      {"uint64_t", VoxelType::uint64},
      {"float", VoxelType::float32},
      {"double", VoxelType::float64},
  };
  const auto found = types.find(lower_case(name));
  if (found == types.end()) {
    fail("field 'type' is '" + name + "', must be a type of integers");
  }
  return found->second;
}

void inflate_gzip(std::string_view packed, std::vector<char>& out) {
  z_stream stream{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // zlib only reads it
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  if (inflateInit2(&stream, 15 + 32) != Z_OK) {
    fail("no memory to unpack it");
  }
  const int result = inflate(&stream, Z_FINISH);
  const std::size_t got = out.size() - stream.avail_out;
  inflateEnd(&stream);
  if (got != out.size()) {
    fail((result == Z_DATA_ERROR ? "damaged: " : "cut off: ") + std::to_string(got) + " bytes of voxels, must be " +
         std::to_string(out.size()));
  }
}

void place(const Header& header, VoxelImage& image) {
  if (const std::string directions = header.get("space directions"); !directions.empty()) {
    const std::vector<double> d = numbers(directions, "space directions");
    if (d.size() != 9) {
      fail("field 'space directions' has " + std::to_string(d.size()) + " numbers, must be 9");
    }
    image.columns = Eigen::Map<const Eigen::Matrix3d>(d.data());
  } else if (const std::string spacings = header.get("spacings"); !spacings.empty()) {
    const std::vector<double> s = numbers(spacings, "spacings");
    if (s.size() != 3) {
      fail("field 'spacings' has " + std::to_string(s.size()) + " numbers, must be 3");
    }
    image.columns = Vec3(s[0], s[1], s[2]).asDiagonal();
  }
  if (const std::string origin = header.get("space origin"); !origin.empty()) {
    const std::vector<double> o = numbers(origin, "space origin");
    if (o.size() != 3) {
      fail("field 'space origin' has " + std::to_string(o.size()) + " numbers, must be 3");
    }
    image.origin = Vec3(o[0], o[1], o[2]);
  }
  const std::string space = lower_case(header.get("space"));
  if (space == "left-posterior-superior" || space == "lps") {
    lps_to_ras(image);
  } else if (space == "left-anterior-superior" || space == "las") {
    image.columns.row(0) *= -1;
    image.origin[0] *= -1;
  }
  std::istringstream words(header.get("space units"));
  std::string unit;
  words >> unit;
  unit.erase(std::remove(unit.begin(), unit.end(), '"'), unit.end());
  image.units = length_unit(unit);
}

}  // namespace

VoxelImage read_nrrd(const std::string& path, std::vector<char>& storage) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const Header header = parse_header(bytes);
  if (header.fields.contains("data file") || header.fields.contains("datafile")) {
    fail("its voxels are in another file: save it as one file (.nrrd)");
  }
  if (header.at("dimension") != "3") {
    fail("it has " + header.at("dimension") + " dimensions, must have 3");
  }
  VoxelImage image;
  image.type = type_of(header.at("type"));
  const std::vector<double> sizes = numbers(header.at("sizes"), "sizes");
  if (sizes.size() != 3) {
    fail("field 'sizes' has " + std::to_string(sizes.size()) + " numbers, must be 3");
  }
  std::size_t size = size_of(image.type);
  for (int d = 0; d < 3; ++d) {
    if (!(sizes[d] >= 1 && sizes[d] <= 1e5)) {
      fail("field 'sizes' has " + std::to_string(sizes[d]) + ", must be 1 to 100000");
    }
    image.size[d] = static_cast<int>(sizes[d]);
    size *= image.size[d];
  }
  place(header, image);
  const std::string_view packed = std::string_view(bytes).substr(header.end);
  const std::string encoding = lower_case(header.at("encoding"));
  if (encoding == "raw") {
    if (packed.size() < size) {
      fail("cut off: " + std::to_string(packed.size()) + " bytes of voxels, must be " + std::to_string(size));
    }
    storage.assign(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size));
  } else if (encoding == "gzip" || encoding == "gz") {
    if (size > 1100 * packed.size() + 1000) {  // more than deflate can ever pack
      fail("cut off: " + std::to_string(packed.size()) + " packed bytes cannot hold " + std::to_string(size));
    }
    storage.resize(size);
    inflate_gzip(packed, storage);
  } else {
    fail("field 'encoding' is '" + encoding + "', must be raw or gzip");
  }
  const std::string endian = lower_case(header.get("endian"));
  const std::size_t voxel = size_of(image.type);
  if (voxel > 1 && endian == (std::endian::native == std::endian::little ? "big" : "little")) {
    for (auto at = storage.begin(); at != storage.end(); at += static_cast<std::ptrdiff_t>(voxel)) {
      std::reverse(at, at + static_cast<std::ptrdiff_t>(voxel));
    }
  }
  image.voxels = storage.data();
  return image;
}

}  // namespace vasohex
