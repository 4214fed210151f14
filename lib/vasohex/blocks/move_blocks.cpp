#include "vasohex/blocks/move_blocks.h"

namespace vasohex {
namespace {

template <class F>
void move(BlockStructure& blocks, F&& point, const Eigen::Matrix3d& rotation, double scale) {
  for (Vec3& p : blocks.nodes) {
    p = point(p);
  }
  for (std::vector<Stretch>& region : blocks.regions) {
    for (Stretch& stretch : region) {
      stretch.from *= scale;
      stretch.to *= scale;
    }
  }
  for (SectionFrame& end : blocks.ends) {
    end = {point(end.origin), rotation * end.x, rotation * end.y, scale * end.radius};
  }
}

}  // namespace

void move_outward(BlockStructure& blocks, const OwnFrame& frame) {
  move(blocks, [&](const Vec3& p) { return frame.outward(p); }, frame.rotation, frame.scale);
}

void move_inward(BlockStructure& blocks, const OwnFrame& frame) {
  move(blocks, [&](const Vec3& p) { return frame.inward(p); }, frame.rotation.transpose(), 1 / frame.scale);
}

}  // namespace vasohex
