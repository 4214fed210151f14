#include "vasohex/skeleton/remesh.h"

// EigenVectorT.hh specialises a class template that it does not include.
// clang-format off
#include <OpenMesh/Core/Utils/vector_traits.hh>
#include <OpenMesh/Core/Geometry/EigenVectorT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
// clang-format on

#include <algorithm>
#include <numbers>

#include "vasohex/skeleton/local_thickness.h"

namespace vasohex {
namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = Vec3;
  using Normal = Vec3;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
  FaceAttributes(OpenMesh::Attributes::Status);
  VertexTraits {
    double size = 0;  ///< length that edges should have here
    int anchor = -1;  ///< index of the end
  };
  FaceTraits { bool is_cap = false; };
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using Vertex = Mesh::VertexHandle;
using Edge = Mesh::EdgeHandle;
using Halfedge = Mesh::HalfedgeHandle;

constexpr int kRounds = 3;          ///< widths are measured anew in each
constexpr int kPasses = 4;          ///< of splits, collapses and flips, in each round
constexpr double kGradation = 0.5;  ///< growth of the size per length

double size_of(const Mesh& mesh, Edge e) {
  const Halfedge h = mesh.halfedge_handle(e, 0);
  return std::min(mesh.data(mesh.from_vertex_handle(h)).size, mesh.data(mesh.to_vertex_handle(h)).size);
}

/// Sizes such that neighbours differ by no more than kGradation of their distance.
void grade(Mesh& mesh) {
  for (bool changed = true; changed;) {
    changed = false;
    for (const Halfedge h : mesh.halfedges()) {
      const Vertex a = mesh.from_vertex_handle(h), b = mesh.to_vertex_handle(h);
      const double most = mesh.data(a).size + kGradation * mesh.calc_edge_length(h);
      if (mesh.data(b).size > most * (1 + 1e-9)) {
        mesh.data(b).size = most;
        changed = true;
      }
    }
  }
}

/// Halves edges longer than 4/3 of their size, the longest first in relation to it.
void split_long(Mesh& mesh) {
  std::vector<std::pair<double, Edge>> longest;
  for (const Edge e : mesh.edges()) {
    if (const double l = mesh.calc_edge_length(e) / size_of(mesh, e); l > 4.0 / 3) {
      longest.emplace_back(-l, e);
    }
  }
  std::sort(longest.begin(), longest.end());
  for (const auto& [l, e] : longest) {
    const Halfedge h = mesh.halfedge_handle(e, 0);
    const Vertex a = mesh.from_vertex_handle(h), b = mesh.to_vertex_handle(h);
    const Vertex middle = mesh.add_vertex((mesh.point(a) + mesh.point(b)) * 0.5);
    mesh.data(middle).size = (mesh.data(a).size + mesh.data(b).size) / 2;
    mesh.split_copy(e, middle);
  }
}

/// Whether moving the start of h to its end turns no triangle by more than 60 degrees and makes no edge too long.
bool may_collapse(const Mesh& mesh, Halfedge h) {
  const Vertex from = mesh.from_vertex_handle(h), to_vertex = mesh.to_vertex_handle(h);
  const Vec3 target = mesh.point(to_vertex);
  for (const Halfedge out : mesh.voh_range(from)) {
    const Vertex b = mesh.to_vertex_handle(out);
    if (b != to_vertex && (mesh.point(b) - target).norm() > 4.0 / 3 * mesh.data(to_vertex).size) {
      return false;
    }
    const Vertex c = mesh.to_vertex_handle(mesh.next_halfedge_handle(out));
    if (b == to_vertex || c == to_vertex) {
      continue;
    }
    const Vec3 pb = mesh.point(b), pc = mesh.point(c), p = mesh.point(from);
    const Vec3 before = (pb - p).cross(pc - p), after = (pb - target).cross(pc - target);
    if (before.dot(after) < 0.5 * before.norm() * after.norm()) {
      return false;
    }
  }
  return true;
}

/// Collapses edges shorter than 4/5 of their size, the shortest first.
void collapse_short(Mesh& mesh) {
  std::vector<std::pair<double, Edge>> shortest;
  for (const Edge e : mesh.edges()) {
    if (const double l = mesh.calc_edge_length(e) / size_of(mesh, e); l < 0.8) {
      shortest.emplace_back(l, e);
    }
  }
  std::sort(shortest.begin(), shortest.end());
  for (const auto& [l, e] : shortest) {
    if (mesh.status(e).deleted() || mesh.calc_edge_length(e) > 0.8 * size_of(mesh, e)) {
      continue;
    }
    for (int side = 0; side < 2; ++side) {
      const Halfedge h = mesh.halfedge_handle(e, side);
      if (mesh.data(mesh.from_vertex_handle(h)).anchor < 0 && mesh.is_collapse_ok(h) && may_collapse(mesh, h)) {
        mesh.collapse(h);
        break;
      }
    }
  }
  mesh.garbage_collection();
}

/// Flips edges whose opposite angles sum up to more than 180 degrees, unless the surface bends at the edge.
void flip_to_delaunay(Mesh& mesh) {
  for (int pass = 0; pass < 5; ++pass) {
    bool changed = false;
    for (const Edge e : mesh.edges()) {
      const Halfedge h = mesh.halfedge_handle(e, 0), o = mesh.halfedge_handle(e, 1);
      if (mesh.data(mesh.face_handle(h)).is_cap != mesh.data(mesh.face_handle(o)).is_cap) {
        continue;
      }
      const Vec3 a = mesh.point(mesh.from_vertex_handle(h)), b = mesh.point(mesh.to_vertex_handle(h));
      const Vec3 c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)));
      const Vec3 d = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(o)));
      const Vec3 n1 = (b - a).cross(c - a), n2 = (a - b).cross(d - b);
      const Vec3 m1 = (d - c).cross(b - c), m2 = (c - d).cross(a - d);
      const bool flat = n1.dot(n2) >= 0.5 * n1.norm() * n2.norm() && m1.dot(m2) > 0.5 * m1.norm() * m2.norm() &&
                        (n1 + n2).dot(m1) > 0 && (n1 + n2).dot(m2) > 0;
      if (flat && angle_between(a - c, b - c) + angle_between(a - d, b - d) > std::numbers::pi + 1e-3 &&
          mesh.is_flip_ok(e)) {
        mesh.flip(e);
        changed = true;
      }
    }
    if (!changed) {
      return;
    }
  }
}

SizedLumen to_lumen(const Mesh& mesh, std::size_t ends) {
  SizedLumen lumen;
  lumen.anchors.assign(ends, -1);
  for (const Vertex v : mesh.vertices()) {
    lumen.surface.points.push_back(mesh.point(v));
    if (mesh.data(v).anchor >= 0) {
      lumen.anchors[mesh.data(v).anchor] = v.idx();
    }
  }
  for (const Mesh::FaceHandle f : mesh.faces()) {
    std::array<int, 3> t{};
    int k = 0;
    for (const Vertex v : mesh.fv_range(f)) {
      t[k++] = v.idx();
    }
    lumen.surface.triangles.push_back(t);
    lumen.is_cap.push_back(mesh.data(f).is_cap);
  }
  return lumen;
}

}  // namespace

SizedLumen remesh(const ClosedLumen& lumen, double edge, const Run& run) {
  Mesh mesh;
  for (const Vec3& p : lumen.surface.points) {
    mesh.add_vertex(p);
  }
  for (std::size_t i = 0; i < lumen.surface.triangles.size(); ++i) {
    const auto& t = lumen.surface.triangles[i];
    mesh.data(mesh.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2]))).is_cap = lumen.is_cap[i];
  }
  for (std::size_t e = 0; e < lumen.anchors.size(); ++e) {
    mesh.data(Vertex(lumen.anchors[e])).anchor = static_cast<int>(e);
  }
  SizedLumen sized;
  for (int round = 0;; ++round) {
    sized = to_lumen(mesh, lumen.anchors.size());
    sized.widths = local_thickness(sized.surface, sized.is_cap, run);
    if (round == kRounds) {
      break;
    }
    for (const Vertex v : mesh.vertices()) {
      mesh.data(v).size = edge * sized.widths[v.idx()];
    }
    grade(mesh);
    for (int pass = 0; pass < kPasses; ++pass) {
      split_long(mesh);
      collapse_short(mesh);
      flip_to_delaunay(mesh);
    }
  }
  return sized;
}

}  // namespace vasohex
