#include "vasohex/skeleton/extract_skeleton.h"

#include "vasohex/core/error.h"
#include "vasohex/core/short_text.h"
#include "vasohex/skeleton/centre_axes.h"
#include "vasohex/skeleton/closed_lumen.h"
#include "vasohex/skeleton/collapse_to_graph.h"
#include "vasohex/skeleton/contract_surface.h"
#include "vasohex/skeleton/point_tree.h"
#include "vasohex/skeleton/remesh.h"
#include "vasohex/skeleton/vessel_graph.h"

namespace vasohex {
namespace {

/// The vessel of each point of the lumen: that of the nearest point of the remeshed one.
std::vector<int> vessels_of(const ClosedLumen& lumen, const SizedLumen& sized, const VesselGraph& graph) {
  const PointTree tree(sized.surface.points);
  std::vector<int> result;
  result.reserve(lumen.surface.points.size());
  for (const Vec3& p : lumen.surface.points) {
    result.push_back(graph.vessel_of[tree.nearest(p)]);
  }
  return result;
}

Skeleton to_skeleton(const CentredAxes& centred) {
  Skeleton skeleton;
  for (const AxisSample& node : centred.nodes) {
    skeleton.points.push_back(node.point);
    skeleton.radii.push_back(node.radius);
  }
  for (const CentredAxis& axis : centred.axes) {
    int before = axis.nodes[0];
    for (std::size_t i = 1; i + 1 < axis.samples.size(); ++i) {
      const int next = static_cast<int>(skeleton.points.size());
      skeleton.points.push_back(axis.samples[i].point);
      skeleton.radii.push_back(axis.samples[i].radius);
      skeleton.segments.push_back({before, next});
      before = next;
    }
    skeleton.segments.push_back({before, axis.nodes[1]});
  }
  return skeleton;
}

}  // namespace

Extraction extract_skeleton(const TriSurface& surface, const std::vector<SurfaceEnd>& ends,
                            const ExtractOptions& options, const Run& run) {
  if (!(options.edge >= 0.05 && options.edge <= 0.6)) {
    throw Error(ErrorCode::bad_input, "edge is " + short_text(options.edge) + " radii, must be 0.05 to 0.6");
  }
  Extraction result;
  const ClosedLumen lumen = close_lumen(surface, ends, result.notes);
  run.progress("remesh", 0);
  const SizedLumen sized = remesh(lumen, options.edge, run);
  const std::vector<Vec3> contracted = contract_surface(sized, run);
  const CurveGraph curves = collapse_to_graph(sized, contracted, lumen.genus);
  if (curves.cycles < lumen.genus) {
    result.notes.push_back("the surface has " + std::to_string(lumen.genus) + " holes, the skeleton only " +
                           std::to_string(curves.cycles) +
                           " cycles: the others closed in the contraction, as holes narrower than .4 radii do");
  }
  const VesselGraph graph = split_into_vessels(curves, sized, lumen, ends, result.notes);
  if (graph.vessels.empty()) {
    throw Error(ErrorCode::bad_input, "the surface has no vessel: no piece of it is longer than wide");
  }
  const CentredAxes centred = centre_axes(graph, lumen, vessels_of(lumen, sized, graph), ends, run);
  result.skeleton = to_skeleton(centred);
  result.skeleton.units = surface.units;
  result.end_points.assign(ends.size(), -1);
  for (std::size_t i = 0; i < centred.end_of.size(); ++i) {
    if (centred.end_of[i] >= 0) {
      result.end_points[centred.end_of[i]] = static_cast<int>(i);
    }
  }
  return result;
}

}  // namespace vasohex
