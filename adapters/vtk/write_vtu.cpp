#include "vtk/write_vtu.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <ostream>

#include "vasohex/core/atomic_file.h"
#include "vasohex/core/error.h"
#include "vasohex/core/reference_hex.h"

namespace vasohex {
namespace {

constexpr int kVtkMaxOrder = 10;
enum CellType : std::uint8_t { kQuad = 9, kHexahedron = 12, kLagrangeQuadrilateral = 70, kLagrangeHexahedron = 72 };

void check_representable(const HexMesh& mesh) {
  if (mesh.order < 1 || mesh.order > kVtkMaxOrder) {
    throw Error(ErrorCode::bad_input, "VTK has hexahedra of orders 1 to " + std::to_string(kVtkMaxOrder) + ", not " +
                                          std::to_string(mesh.order) + ": generate the mesh with a lower order");
  }
  if (mesh.order >= 3 && mesh.family != NodeFamily::equispaced) {
    throw Error(ErrorCode::bad_input,
                "VTU means equispaced nodes, this mesh of order " + std::to_string(mesh.order) +
                    " has others and would be bent silently: generate it with equispaced nodes");
  }
}

std::string escaped(const std::string& text) {
  std::string s;
  for (const char c : text) {
    switch (c) {
      case '&':
        s += "&amp;";
        break;
      case '<':
        s += "&lt;";
        break;
      case '>':
        s += "&gt;";
        break;
      case '"':
        s += "&quot;";
        break;
      default:
        s += c;
    }
  }
  return s;
}

template <class T>
constexpr const char* type_name();
template <>
constexpr const char* type_name<double>() {
  return "Float64";
}
template <>
constexpr const char* type_name<std::int32_t>() {
  return "Int32";
}
template <>
constexpr const char* type_name<std::int64_t>() {
  return "Int64";
}
template <>
constexpr const char* type_name<std::uint8_t>() {
  return "UInt8";
}

/// Arrays of a VTU file: described in XML first, their numbers appended, formed one by one while writing.
class AppendedArrays {
 public:
  /// `value(i)` for i in [0, count).
  template <class T, class F>
  std::string add(const std::string& name, int components, std::size_t count, F value) {
    std::string xml =
        "        <DataArray type=\"" + std::string(type_name<T>()) + "\" Name=\"" + escaped(name) + "\"";
    if (components > 1) {
      xml += " NumberOfComponents=\"" + std::to_string(components) + "\"";
    }
    xml += " format=\"appended\" offset=\"" + std::to_string(size_) + "\"/>\n";
    size_ += sizeof(std::uint64_t) + count * sizeof(T);
    arrays_.push_back([count, value = std::move(value)](AtomicFile& file) {
      const auto put = [&](const auto* data, std::size_t n) {
        file.stream().write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(n * sizeof *data));
      };
      const std::uint64_t bytes = count * sizeof(T);
      put(&bytes, 1);
      std::vector<T> piece;
      for (std::size_t begin = 0; begin < count; begin += kPiece) {
        piece.clear();
        for (std::size_t i = begin; i < std::min(count, begin + kPiece); ++i) {
          piece.push_back(value(i));
        }
        put(piece.data(), piece.size());
        file.check();
      }
    });
    return xml;
  }

  void write(AtomicFile& file, const Run& run) const {
    for (std::size_t a = 0; a < arrays_.size(); ++a) {
      run.progress("write", static_cast<double>(a) / static_cast<double>(arrays_.size()));
      arrays_[a](file);
    }
  }

 private:
  static constexpr std::size_t kPiece = 1 << 17;
  std::uint64_t size_ = 0;
  std::vector<std::function<void(AtomicFile&)>> arrays_;
};

/// Cells of one kind.
struct Grid {
  std::size_t points = 0;
  std::function<double(std::size_t)> coordinate;  ///< [points][3]
  std::size_t cells = 0;
  std::size_t nodes_per_cell = 0;
  std::function<std::int64_t(std::size_t)> connectivity;  ///< [cells][nodes_per_cell]
  CellType type = kHexahedron;
  std::string units;
};

void write_grid(const Grid& grid, const std::string& path, AppendedArrays& arrays, const std::string& point_data,
                const std::string& cell_data, const Run& run) {
  const bool little = std::endian::native == std::endian::little;
  std::string xml = "<?xml version=\"1.0\"?>\n";
  if (!grid.units.empty()) {
    // two hyphens would end the comment
    std::string units = grid.units;
    std::replace(units.begin(), units.end(), '-', '_');
    xml += "<!-- lengths in " + units + " -->\n";
  }
  xml += "<VTKFile type=\"UnstructuredGrid\" version=\"2.2\" byte_order=\"" +
         std::string(little ? "LittleEndian" : "BigEndian") + "\" header_type=\"UInt64\">\n  <UnstructuredGrid>\n" +
         "    <Piece NumberOfPoints=\"" + std::to_string(grid.points) + "\" NumberOfCells=\"" +
         std::to_string(grid.cells) + "\">\n";
  xml += "      <PointData>\n" + point_data + "      </PointData>\n";
  xml += "      <CellData>\n" + cell_data + "      </CellData>\n";
  xml += "      <Points>\n" + arrays.add<double>("Points", 3, 3 * grid.points, grid.coordinate) + "      </Points>\n";
  xml += "      <Cells>\n";
  xml += arrays.add<std::int64_t>("connectivity", 1, grid.cells * grid.nodes_per_cell, grid.connectivity);
  xml += arrays.add<std::int64_t>("offsets", 1, grid.cells,
                                  [&](std::size_t c) { return std::int64_t((c + 1) * grid.nodes_per_cell); });
  xml += arrays.add<std::uint8_t>("types", 1, grid.cells, [&](std::size_t) { return grid.type; });
  xml += "      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_";

  AtomicFile file(path);
  file.stream() << xml;
  arrays.write(file, run);
  file.stream() << "\n  </AppendedData>\n</VTKFile>\n";
  file.commit();
  run.progress("write", 1);
}

}  // namespace

std::vector<int> vtk_quad_order(int order) {
  const int p = order, n = p + 1;
  std::vector<int> places{0, p, p + n * p, n * p};
  const auto along_i = [&](int j) {
    for (int i = 1; i < p; ++i) {
      places.push_back(i + n * j);
    }
  };
  const auto along_j = [&](int i) {
    for (int j = 1; j < p; ++j) {
      places.push_back(i + n * j);
    }
  };
  along_i(0);
  along_j(p);
  along_i(p);
  along_j(0);
  for (int j = 1; j < p; ++j) {
    along_i(j);
  }
  return places;
}

std::vector<int> vtk_hex_order(int order) {
  const int p = order, n = p + 1;
  std::vector<int> places;
  const auto add = [&](int i, int j, int k) { places.push_back(i + n * (j + n * k)); };
  for (const int k : {0, p}) {
    add(0, 0, k);
    add(p, 0, k);
    add(p, p, k);
    add(0, p, k);
  }
  // every edge runs upward in its coordinate
  for (const int k : {0, p}) {
    for (int i = 1; i < p; ++i) {
      add(i, 0, k);
    }
    for (int j = 1; j < p; ++j) {
      add(p, j, k);
    }
    for (int i = 1; i < p; ++i) {
      add(i, p, k);
    }
    for (int j = 1; j < p; ++j) {
      add(0, j, k);
    }
  }
  for (const auto& [i, j] : {std::array{0, 0}, std::array{p, 0}, std::array{p, p}, std::array{0, p}}) {
    for (int k = 1; k < p; ++k) {
      add(i, j, k);
    }
  }
  for (const int i : {0, p}) {
    for (int k = 1; k < p; ++k) {
      for (int j = 1; j < p; ++j) {
        add(i, j, k);
      }
    }
  }
  for (const int j : {0, p}) {
    for (int k = 1; k < p; ++k) {
      for (int i = 1; i < p; ++i) {
        add(i, j, k);
      }
    }
  }
  for (const int k : {0, p}) {
    for (int j = 1; j < p; ++j) {
      for (int i = 1; i < p; ++i) {
        add(i, j, k);
      }
    }
  }
  for (int k = 1; k < p; ++k) {
    for (int j = 1; j < p; ++j) {
      for (int i = 1; i < p; ++i) {
        add(i, j, k);
      }
    }
  }
  return places;
}

void write_vtu(const HexMesh& mesh, const std::string& path, std::span<const CellScalars> scalars, const Run& run) {
  check_representable(mesh);
  const std::vector<int> order = vtk_hex_order(mesh.order);
  Grid grid;
  grid.points = mesh.nodes.size();
  grid.coordinate = [&](std::size_t i) { return mesh.nodes[i / 3][i % 3]; };
  grid.nodes_per_cell = order.size();
  grid.cells = mesh.elements.size() / order.size();
  grid.connectivity = [&](std::size_t i) {
    return mesh.elements[i / order.size() * order.size() + order[i % order.size()]];
  };
  grid.type = mesh.order == 1 ? kHexahedron : kLagrangeHexahedron;
  grid.units = mesh.units;

  AppendedArrays arrays;
  std::string cell_data;
  if (!mesh.element_block.empty()) {
    cell_data +=
        arrays.add<std::int32_t>("block", 1, grid.cells, [&](std::size_t c) { return mesh.element_block[c]; });
  }
  if (!mesh.element_branch.empty()) {
    cell_data +=
        arrays.add<std::int32_t>("branch", 1, grid.cells, [&](std::size_t c) { return mesh.element_branch[c]; });
  }
  for (const CellScalars& s : scalars) {
    if (s.values.size() != grid.cells) {
      throw Error(ErrorCode::bad_input, "cell data '" + s.name + "' holds " + std::to_string(s.values.size()) +
                                            " numbers for " + std::to_string(grid.cells) + " elements");
    }
    cell_data += arrays.add<double>(s.name, 1, grid.cells, [&s](std::size_t c) { return s.values[c]; });
  }
  write_grid(grid, path, arrays, "", cell_data, run);
}

void write_vtu_boundary(const HexMesh& mesh, const std::string& path, const Run& run) {
  check_representable(mesh);
  const std::array<int, 3> lattice{mesh.order + 1, mesh.order + 1, mesh.order + 1};
  const std::vector<int> order = vtk_quad_order(mesh.order);
  const std::size_t per_hex = mesh.nodes_per_element();
  std::vector<int> point_of(mesh.nodes.size(), -1), node_of, connectivity;
  for (const HexMesh::BoundaryFace& b : mesh.boundary) {
    for (const int place : order) {
      const int at = hex_face_point(b.face, place % (mesh.order + 1), place / (mesh.order + 1), lattice);
      const int node = mesh.elements[b.element * per_hex + at];
      if (point_of[node] < 0) {
        point_of[node] = static_cast<int>(node_of.size());
        node_of.push_back(node);
      }
      connectivity.push_back(point_of[node]);
    }
  }
  Grid grid;
  grid.points = node_of.size();
  grid.coordinate = [&](std::size_t i) { return mesh.nodes[node_of[i / 3]][i % 3]; };
  grid.nodes_per_cell = order.size();
  grid.cells = mesh.boundary.size();
  grid.connectivity = [&](std::size_t i) { return connectivity[i]; };
  grid.type = mesh.order == 1 ? kQuad : kLagrangeQuadrilateral;
  grid.units = mesh.units;

  AppendedArrays arrays;
  const std::string point_data =
      arrays.add<std::int32_t>("node", 1, grid.points, [&](std::size_t i) { return node_of[i]; });
  const std::string cell_data =
      arrays.add<std::int32_t>("surface", 1, grid.cells, [&](std::size_t c) { return mesh.boundary[c].surface + 1; });
  write_grid(grid, path, arrays, point_data, cell_data, run);
}

}  // namespace vasohex
