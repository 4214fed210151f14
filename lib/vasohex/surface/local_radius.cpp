#include "vasohex/surface/local_radius.h"

#include <utility>

#include "vasohex/core/error.h"

namespace vasohex {
namespace {

std::vector<ConeSegment> segments_of(const Network& network) {
  std::vector<ConeSegment> segments;
  for (const Branch& branch : network.branches) {
    for (std::size_t i = 0; i + 1 < branch.points.size(); ++i) {
      if (!(branch.radii[i] > 0 && branch.radii[i + 1] > 0)) {
        throw Error(ErrorCode::bad_input, "a radius of the network is not positive");
      }
      if (branch.points[i] != branch.points[i + 1]) {
        segments.push_back(
            cone_segment(branch.points[i], branch.radii[i], branch.points[i + 1], branch.radii[i + 1], 0));
      }
    }
  }
  if (segments.empty()) {
    throw Error(ErrorCode::bad_input, "the network has no branch of two points; radii are taken from it");
  }
  return segments;
}

}  // namespace

LocalRadius::LocalRadius(const Network& network) : tree_(segments_of(network)) {}

}  // namespace vasohex
