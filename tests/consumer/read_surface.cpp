// Reads a surface through VTK: vtk_consumer FILE.vtk

#include <cstdio>

#include "vasohex/core/error.h"
#include "vtk/read_poly_surface.h"

int main(int, char** argv) {
  try {
    const vasohex::TriSurface surface = vasohex::read_poly_surface(argv[1]);
    std::printf("%zu triangles\n", surface.triangles.size());
    return surface.triangles.size() == 4 ? 0 : 1;
  } catch (const vasohex::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
