#include "vasohex/mesh/move_mesh.h"

namespace vasohex {

Grading in_frame(Grading grading, const OwnFrame& frame) {
  if (grading.layers && !grading.layers->relative) {
    grading.layers->first_height /= frame.scale;
  }
  return grading;
}

void move_outward(MeshResult& result, const OwnFrame& frame) {
  for (Vec3& p : result.mesh.nodes) {
    p = frame.outward(p);
  }
  for (Vec3* place : {&result.relaxed.place, &result.unconverged_place}) {
    *place = frame.outward(*place);
  }
}

}  // namespace vasohex
