// Writes the curved boxes and the skeleton that the Python oracles read: oracle_files FOLDER

#include <filesystem>

#include "curved_box.h"
#include "gmsh/write_msh.h"
#include "vtk/write_vtp.h"
#include "vtk/write_vtu.h"

int main(int, char** argv) {
  const std::filesystem::path folder = argv[1];
  for (int p = 1; p <= 9; ++p) {
    const vasohex::HexMesh mesh = vasohex::curved_box(p, {2, 1, 3});
    const std::string name = "p" + std::to_string(p);
    vasohex::write_msh(mesh, folder / (name + ".msh"));
    std::vector<double> scalar;
    for (int e = 0; e < mesh.element_count(); ++e) {
      scalar.push_back(0.5 * e);
    }
    const vasohex::CellScalars scalars[] = {{"a <&\"> b", scalar}};
    vasohex::write_vtu(mesh, folder / (name + ".vtu"), scalars);
    vasohex::write_vtu_boundary(mesh, folder / (name + "_boundary.vtu"));
  }
  // a ring and a branch that leaves it
  vasohex::Skeleton ring;
  for (int i = 0; i < 5; ++i) {
    ring.points.push_back(vasohex::Vec3(i / 3.0, i * i, 0.1));
    ring.radii.push_back(1 / (i + 3.0));
  }
  ring.segments = {{0, 1}, {1, 2}, {2, 0}, {2, 3}, {3, 4}};
  vasohex::write_vtp(ring, folder / "ring.vtp");
}
