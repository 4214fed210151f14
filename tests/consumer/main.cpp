// Meshes a straight tube with hexahedra of order 3: consumer FILE.msh

#include <cstdio>

#include "gmsh/write_msh.h"
#include "vasohex/quality/quality_report.h"
#include "vasohex/vasohex.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: consumer FILE.msh\n");
    return 2;
  }
  vasohex::Skeleton tube;
  tube.points = {{0, 0, 0}, {0, 0, 5}, {0, 0, 10}};
  tube.radii = {1, 1, 1};
  tube.segments = {{0, 1}, {1, 2}};
  tube.units = "mm";

  vasohex::SkeletonMeshOptions options;
  options.mesh.order = 3;
  options.grading.elements = 2;
  try {
    const vasohex::HexMesh mesh = vasohex::mesh_skeleton(tube, options).result.mesh;
    const vasohex::QualityReport quality = vasohex::measure_quality(mesh);
    vasohex::write_msh(mesh, argv[1]);
    std::printf("%d of %d hexahedra are certified\n", quality.certified, mesh.element_count());
    return quality.certified == mesh.element_count() ? 0 : 3;
  } catch (const vasohex::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
