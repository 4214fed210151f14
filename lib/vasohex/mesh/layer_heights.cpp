#include "vasohex/mesh/layer_heights.h"

#include <cmath>

#include "vasohex/core/reference_hex.h"

namespace vasohex {

double first_layer_kept(const HexMesh& mesh, const ImplicitSurface& surface, const WallLayers& layers) {
  const int n = mesh.order + 1;
  long kept = 0, all = 0;
  for (const HexMesh::BoundaryFace& face : mesh.boundary) {
    if (mesh.surfaces[face.surface] != "wall") {
      continue;
    }
    const int* ids = &mesh.elements[static_cast<std::size_t>(face.element) * mesh.nodes_per_element()];
    for (int b = 0; b < n; ++b) {
      for (int a = 0; a < n; ++a) {
        const Vec3& wall = mesh.nodes[ids[hex_face_point(face.face, a, b, {n, n, n})]];
        // (a, b) of the opposite face, whose axes are swapped
        const Vec3& below = mesh.nodes[ids[hex_face_point(face.face ^ 1, b, a, {n, n, n})]];
        Vec3 gradient;
        const double value = surface.value(below, gradient);
        const double wanted = layers.first_height * (layers.relative ? surface.radius(wall) : 1.0);
        kept += std::abs(-value / gradient.norm() / wanted - 1) < 0.1;
        ++all;
      }
    }
  }
  return all > 0 ? static_cast<double>(kept) / all : 1.0;
}

}  // namespace vasohex
