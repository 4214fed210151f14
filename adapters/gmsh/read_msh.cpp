#include "gmsh/read_msh.h"

#include <gmsh.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <unordered_map>

#include "gmsh/node_order.h"
#include "vasohex/core/error.h"
#include "vasohex/core/reference_hex.h"
#include "vasohex/core/text_lines.h"

namespace vasohex {
namespace {

/// Gmsh would run any other text file as a script and read other extensions as other formats.
void check_is_msh(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!std::filesystem::is_regular_file(path) || !file) {
    throw Error(ErrorCode::bad_input, "no such file, or it cannot be read");
  }
  if (lower_extension(path) != ".msh") {
    throw Error(ErrorCode::bad_input, "the name must end in .msh");
  }
  std::string head(256, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(file.gcount());
  const std::size_t start = head.find_first_not_of(" \t\r\n");
  const std::string keyword = "$MeshFormat";
  if (start == std::string::npos || head.compare(start, keyword.size(), keyword) != 0) {
    throw Error(ErrorCode::bad_input, "not an MSH file: it does not begin with $MeshFormat");
  }
  const std::size_t version = head.find_first_not_of(" \t\r\n", start + keyword.size());
  if (version == std::string::npos || (head[version] != '2' && head[version] != '4')) {
    throw Error(ErrorCode::bad_input, "not MSH 2 or 4: save it in version 4.1");
  }
}

class GmshSession {
 public:
  GmshSession() {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
  }
  ~GmshSession() { gmsh::finalize(); }
};

/// Calls f; whatever Gmsh throws becomes an Error.
template <class F>
void with_gmsh(F&& f) {
  std::string cause;
  try {
    f();
    return;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    cause = e.what();
  } catch (const std::string& e) {
    cause = e;
  } catch (...) {
    gmsh::logger::getLastError(cause);
  }
  throw Error(ErrorCode::bad_input, "Gmsh cannot read it: " + cause);
}

struct Elements {
  std::string kind;
  int type = 0;
  std::vector<std::size_t> nodes;  ///< tags, in Gmsh's order
};

/// Of dimension `dimension` on the entity, or everywhere for entity -1.
std::vector<Elements> elements_of(int dimension, int entity) {
  std::vector<int> types;
  std::vector<std::vector<std::size_t>> tags, nodes;
  gmsh::model::mesh::getElements(types, tags, nodes, dimension, entity);
  std::vector<Elements> result;
  for (std::size_t t = 0; t < types.size(); ++t) {
    Elements e;
    int dim, order, count, primary;
    std::vector<double> local;
    gmsh::model::mesh::getElementProperties(types[t], e.kind, dim, order, count, local, primary);
    e.type = types[t];
    e.nodes = std::move(nodes[t]);
    result.push_back(std::move(e));
  }
  return result;
}

/// Order of complete hexahedra of this type.
int hex_order_of(const Elements& elements) {
  for (int p = 1; p <= kGmshMaxOrder; ++p) {
    if (gmsh_hex_type(p) == elements.type) {
      return p;
    }
  }
  const bool hex = elements.kind.find("Hexahedron") != std::string::npos;
  throw Error(ErrorCode::bad_input, "it holds elements of the kind '" + elements.kind + "'" +
                                        (hex ? ", which lack nodes on faces or inside: save complete hexahedra "
                                               "(Mesh.SecondOrderIncomplete = 0)"
                                             : ": only meshes of hexahedra alone can be read"));
}

using FaceKey = std::array<int, 4>;

FaceKey face_key(FaceKey corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

struct Face {
  FaceKey key;
  HexMesh::BoundaryFace face;
};

/// Faces of one element only, by key.
std::vector<Face> boundary_faces(const HexMesh& mesh) {
  const int p = mesh.order, n = p + 1, per_hex = mesh.nodes_per_element();
  std::vector<Face> all;
  all.reserve(static_cast<std::size_t>(mesh.element_count()) * 6);
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (int f = 0; f < 6; ++f) {
      FaceKey corners;
      for (int c = 0; c < 4; ++c) {
        const int at = hex_face(f)[c];
        corners[c] = mesh.elements[static_cast<std::size_t>(e) * per_hex +
                                   p * ((at & 1) + n * ((at >> 1 & 1) + n * (at >> 2)))];
      }
      all.push_back({face_key(corners), {e, f, -1}});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Face& a, const Face& b) { return a.key < b.key; });
  std::vector<Face> single;
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i + 1;
    while (end < all.size() && all[end].key == all[i].key) {
      ++end;
    }
    if (end == i + 1) {
      single.push_back(all[i]);
    }
    i = end;
  }
  return single;
}

std::string physical_name(int dimension, int tag, const std::string& fallback) {
  std::string name;
  gmsh::model::getPhysicalName(dimension, tag, name);
  return name.empty() ? fallback : name;
}

void read_elements(HexMesh& mesh, std::unordered_map<std::size_t, int>& row) {
  std::vector<Elements> kinds = elements_of(3, -1);
  if (kinds.empty()) {
    throw Error(ErrorCode::bad_input, "it holds no hexahedra");
  }
  for (const Elements& e : kinds) {
    mesh.order = hex_order_of(e);
  }
  const std::vector<std::size_t> hexes = std::move(kinds[0].nodes);
  // Gmsh 4.8 shows only the first kind of the hexahedra of one entity, but counts all
  double count = 0;
  gmsh::option::getNumber("Mesh.NbHexahedra", count);
  if (kinds.size() > 1 || hexes.size() != count * mesh.nodes_per_element()) {
    throw Error(ErrorCode::bad_input, "it holds hexahedra of several orders: all must have the same");
  }

  std::vector<std::size_t> tags;
  std::vector<double> xyz, parametric;
  gmsh::model::mesh::getNodes(tags, xyz, parametric, -1, -1, false, false);
  for (const std::size_t tag : hexes) {
    row[tag] = -1;
  }
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const auto found = row.find(tags[i]);
    if (found == row.end()) {
      continue;
    }
    found->second = static_cast<int>(mesh.nodes.size());
    mesh.nodes.emplace_back(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
    if (!mesh.nodes.back().allFinite()) {
      throw Error(ErrorCode::bad_input, "node " + std::to_string(tags[i]) + " has a coordinate that is not finite");
    }
  }
  const std::vector<int> order = gmsh_hex_order(mesh.order);
  mesh.elements.resize(hexes.size());
  for (std::size_t i = 0; i < hexes.size(); ++i) {
    const int node = row.at(hexes[i]);
    if (node < 0) {
      throw Error(ErrorCode::bad_input, "a hexahedron names node " + std::to_string(hexes[i]) + ", which is missing");
    }
    mesh.elements[i / order.size() * order.size() + order[i % order.size()]] = node;
  }
}

void read_surfaces(HexMesh& mesh, const std::unordered_map<std::size_t, int>& row, const Run& run) {
  std::vector<Face> faces = boundary_faces(mesh);
  const auto node = [&](std::size_t tag) {
    const auto found = row.find(tag);
    return found == row.end() ? -1 : found->second;
  };
  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups, 2);
  std::size_t unused = 0;
  for (const auto& [dimension, tag] : groups) {
    const int surface = static_cast<int>(mesh.surfaces.size());
    mesh.surfaces.push_back(physical_name(2, tag, "surface_" + std::to_string(tag)));
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(2, tag, entities);
    for (const int entity : entities) {
      for (const Elements& e : elements_of(2, entity)) {
        if (e.type != gmsh_quad_type(mesh.order)) {
          throw Error(ErrorCode::bad_input, "surface " + mesh.surfaces.back() + " holds elements of the kind '" +
                                                e.kind + "', which are not faces of hexahedra of order " +
                                                std::to_string(mesh.order));
        }
        const std::size_t per_quad = static_cast<std::size_t>(mesh.order + 1) * (mesh.order + 1);
        for (std::size_t q = 0; q < e.nodes.size(); q += per_quad) {
          const FaceKey key =
              face_key({node(e.nodes[q]), node(e.nodes[q + 1]), node(e.nodes[q + 2]), node(e.nodes[q + 3])});
          const auto face = std::lower_bound(faces.begin(), faces.end(), key,
                                             [](const Face& a, const FaceKey& b) { return a.key < b; });
          if (face == faces.end() || face->key != key || face->face.surface >= 0) {
            ++unused;
          } else {
            face->face.surface = surface;
          }
        }
      }
    }
  }
  if (unused > 0) {
    run.log("read: " + std::to_string(unused) + " quadrangles lie on no boundary face, or on one that has a surface");
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return std::array{a.face.element, a.face.face} < std::array{b.face.element, b.face.face};
  });
  const int untagged = static_cast<int>(mesh.surfaces.size());
  for (const Face& f : faces) {
    mesh.boundary.push_back(f.face);
    if (f.face.surface < 0) {
      mesh.boundary.back().surface = untagged;
      mesh.surfaces.resize(untagged + 1, "untagged");
    }
  }
}

}  // namespace

HexMesh read_msh(const std::string& path, const Run& run) {
  HexMesh mesh;
  with_context(path, [&] {
    check_is_msh(path);
    run.progress("read", 0);
    GmshSession session;
    with_gmsh([&] {
      gmsh::open(path);
      std::unordered_map<std::size_t, int> row;
      read_elements(mesh, row);
      read_surfaces(mesh, row, run);
      gmsh::vectorpair volumes;
      gmsh::model::getPhysicalGroups(volumes, 3);
      if (!volumes.empty()) {
        mesh.volume = physical_name(3, volumes[0].second, mesh.volume);
      }
    });
    run.progress("read", 1);
  });
  return mesh;
}

}  // namespace vasohex
