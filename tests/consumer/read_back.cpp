// Reads a mesh through Gmsh: gmsh_consumer FILE.msh

#include <cstdio>

#include "gmsh/read_msh.h"

int main(int, char** argv) {
  try {
    const vasohex::HexMesh mesh = vasohex::read_msh(argv[1]);
    std::printf("%d hexahedra of order %d, surfaces:", mesh.element_count(), mesh.order);
    for (const std::string& name : mesh.surfaces) {
      std::printf(" %s", name.c_str());
    }
    std::printf("\n");
    return mesh.order == 3 && mesh.surfaces.size() == 3 ? 0 : 1;
  } catch (const vasohex::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
