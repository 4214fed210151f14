// Prints what read_labelmap makes of a file: labelmap_points FILE [LABEL..]. First line the unit, then the centre of
// each voxel inside. For labelmap_oracle.py.

#include <cstdio>
#include <cstdlib>
#include <vector>

#include "vasohex/core/error.h"
#include "vtk/read_labelmap.h"

int main(int argc, char** argv) {
  std::vector<int> labels;
  for (int i = 2; i < argc; ++i) {
    labels.push_back(std::atoi(argv[i]));
  }
  try {
    const vasohex::LabelVolume volume = vasohex::read_labelmap(argv[1], labels);
    std::printf("unit %s\n", volume.units.c_str());
    for (std::size_t i = 0; i < volume.inside.size(); ++i) {
      if (volume.inside[i]) {
        const vasohex::Vec3 x = volume.centre(i);
        std::printf("%.9g %.9g %.9g\n", x.x(), x.y(), x.z());
      }
    }
  } catch (const vasohex::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return e.code() == vasohex::ErrorCode::bad_input ? 2 : 1;
  }
}
