#include "gmsh/write_msh.h"

#include <array>
#include <cstdint>
#include <ostream>
#include <vector>

#include "gmsh/node_order.h"
#include "vasohex/core/atomic_file.h"
#include "vasohex/core/error.h"
#include "vasohex/core/reference_hex.h"

namespace vasohex {
namespace {

void check_representable(const HexMesh& mesh) {
  if (mesh.order < 1 || mesh.order > kGmshMaxOrder) {
    throw Error(ErrorCode::bad_input, "MSH has hexahedra of orders 1 to " + std::to_string(kGmshMaxOrder) + ", not " +
                                          std::to_string(mesh.order) + ": generate the mesh with a lower order");
  }
  if (mesh.order >= 3 && mesh.family != NodeFamily::equispaced) {
    throw Error(ErrorCode::bad_input,
                "MSH means equispaced nodes, this mesh of order " + std::to_string(mesh.order) +
                    " has others and would be bent silently: generate it with equispaced nodes");
  }
}

/// Puts numbers one after the other into the file as they lie in memory, in large pieces. MSH tells readers the byte
/// order by the integer 1 in the header.
class BinaryWriter {
 public:
  explicit BinaryWriter(AtomicFile& file) : file_(file) {}
  template <class T>
  void put(T value) {
    const char* bytes = reinterpret_cast<const char*>(&value);
    buffer_.insert(buffer_.end(), bytes, bytes + sizeof value);
    if (buffer_.size() >= kPiece) {
      flush();
    }
  }
  void put(const Vec3& x) {
    put(x[0]);
    put(x[1]);
    put(x[2]);
  }
  void text(const std::string& s) {
    flush();
    file_.stream() << s;
  }
  void flush() {
    file_.stream().write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
    file_.check();
  }

 private:
  static constexpr std::size_t kPiece = 1 << 20;
  AtomicFile& file_;
  std::vector<char> buffer_;
};

/// A double quote would end the name.
std::string quoted(const std::string& name) {
  std::string s = "\"";
  for (const char c : name) {
    s += c == '"' || c == '\n' ? '\'' : c;
  }
  return s + "\"";
}

void put_box(const Box& box, BinaryWriter& out) {
  out.put(box.empty() ? Vec3(Vec3::Zero()) : box.min);
  out.put(box.empty() ? Vec3(Vec3::Zero()) : box.max);
}

}  // namespace

void write_msh(const HexMesh& mesh, const std::string& path, const Run& run) {
  check_representable(mesh);
  const int p = mesh.order;
  const std::array<int, 3> lattice{p + 1, p + 1, p + 1};
  const std::size_t per_hex = mesh.nodes_per_element();
  const std::size_t hexes = mesh.elements.size() / per_hex;
  const std::vector<int> hex_order = gmsh_hex_order(p), quad_order = gmsh_quad_order(p);
  /// Place of each quadrangle node within the hexahedron, per face.
  std::array<std::vector<int>, 6> face_order;
  for (int f = 0; f < 6; ++f) {
    for (const int q : quad_order) {
      face_order[f].push_back(hex_face_point(f, q % (p + 1), q / (p + 1), lattice));
    }
  }
  const auto node_of = [&](std::size_t element, int place) { return mesh.elements[element * per_hex + place]; };

  std::vector<std::vector<HexMesh::BoundaryFace>> faces(mesh.surfaces.size());
  std::vector<Box> surface_box(mesh.surfaces.size());
  for (const HexMesh::BoundaryFace& b : mesh.boundary) {
    faces.at(b.surface).push_back(b);
    for (const int place : face_order[b.face]) {
      surface_box[b.surface].add(mesh.nodes[node_of(b.element, place)]);
    }
  }
  Box volume_box;
  for (const Vec3& x : mesh.nodes) {
    volume_box.add(x);
  }
  const int volume_tag = static_cast<int>(mesh.surfaces.size()) + 1;

  AtomicFile file(path);
  BinaryWriter out(file);
  out.text("$MeshFormat\n4.1 1 8\n");
  out.put<std::int32_t>(1);
  out.text("\n$EndMeshFormat\n$PhysicalNames\n" + std::to_string(volume_tag) + "\n");
  for (std::size_t s = 0; s < mesh.surfaces.size(); ++s) {
    out.text("2 " + std::to_string(s + 1) + " " + quoted(mesh.surfaces[s]) + "\n");
  }
  out.text("3 " + std::to_string(volume_tag) + " " + quoted(mesh.volume) + "\n$EndPhysicalNames\n$Entities\n");
  for (const std::uint64_t count : {std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{mesh.surfaces.size()},
                                    std::uint64_t{1}}) {  // points, curves, surfaces, volumes
    out.put(count);
  }
  for (std::size_t s = 0; s < mesh.surfaces.size(); ++s) {
    out.put<std::int32_t>(static_cast<int>(s) + 1);
    put_box(surface_box[s], out);
    out.put<std::uint64_t>(1);
    out.put<std::int32_t>(static_cast<int>(s) + 1);
    out.put<std::uint64_t>(0);  // bounding curves
  }
  out.put<std::int32_t>(volume_tag);
  put_box(volume_box, out);
  out.put<std::uint64_t>(1);
  out.put<std::int32_t>(volume_tag);
  out.put<std::uint64_t>(mesh.surfaces.size());
  for (std::size_t s = 0; s < mesh.surfaces.size(); ++s) {
    out.put<std::int32_t>(static_cast<int>(s) + 1);
  }

  out.text("\n$EndEntities\n$Nodes\n");
  const std::uint64_t nodes = mesh.nodes.size();
  for (const std::uint64_t x : {std::uint64_t{1}, nodes, std::uint64_t{1}, nodes}) {  // blocks, nodes, tags from, to
    out.put(x);
  }
  out.put<std::int32_t>(3);
  out.put<std::int32_t>(volume_tag);
  out.put<std::int32_t>(0);  // not parametric
  out.put(nodes);
  for (std::uint64_t tag = 1; tag <= nodes; ++tag) {
    out.put(tag);
  }
  for (const Vec3& x : mesh.nodes) {
    out.put(x);
  }
  run.progress("write", 0.5);

  out.text("\n$EndNodes\n$Elements\n");
  std::uint64_t blocks = hexes > 0;
  for (const auto& f : faces) {
    blocks += !f.empty();
  }
  const std::uint64_t elements = mesh.boundary.size() + hexes;
  for (const std::uint64_t x : {blocks, elements, std::uint64_t{1}, elements}) {
    out.put(x);
  }
  std::uint64_t tag = 0;
  for (std::size_t s = 0; s < faces.size(); ++s) {
    if (faces[s].empty()) {
      continue;
    }
    out.put<std::int32_t>(2);
    out.put<std::int32_t>(static_cast<int>(s) + 1);
    out.put<std::int32_t>(gmsh_quad_type(p));
    out.put<std::uint64_t>(faces[s].size());
    for (const HexMesh::BoundaryFace& b : faces[s]) {
      out.put(++tag);
      for (const int place : face_order[b.face]) {
        out.put<std::uint64_t>(node_of(b.element, place) + std::uint64_t{1});
      }
    }
  }
  if (hexes > 0) {
    out.put<std::int32_t>(3);
    out.put<std::int32_t>(volume_tag);
    out.put<std::int32_t>(gmsh_hex_type(p));
    out.put<std::uint64_t>(hexes);
    for (std::size_t e = 0; e < hexes; ++e) {
      out.put(++tag);
      for (const int place : hex_order) {
        out.put<std::uint64_t>(node_of(e, place) + std::uint64_t{1});
      }
      if (e % 65536 == 65535) {
        run.progress("write", 0.5 + 0.5 * static_cast<double>(e) / static_cast<double>(hexes));
      }
    }
  }
  out.text("\n$EndElements\n");
  file.commit();
  run.progress("write", 1);
}

}  // namespace vasohex
