#include "vasohex/surface/prepare_surface.h"

#include <utility>

#include "vasohex/core/error.h"
#include "vasohex/surface/ragged_ends.h"
#include "vasohex/surface/repair_triangles.h"
#include "vasohex/surface/surface_ends.h"

namespace vasohex {

PreparedSurface prepare_surface(TriSurface surface) {
  PreparedSurface result;
  check_triangles(surface);
  weld_points(surface, result.repairs);
  drop_copies(surface, result.repairs);
  weld_cracks(surface, result.repairs);
  separate_sheets(surface, result.repairs);
  orient_outward(surface, result.repairs);
  flip_needles(surface, result.repairs);
  result.components = drop_fragments(surface, result.repairs);
  if (surface.triangles.empty()) {
    throw Error(ErrorCode::bad_input, "no triangles remain; the surface must enclose a lumen");
  }
  drop_caps(surface, result.repairs);
  close_holes(surface, result.repairs);
  cut_ragged_ends(surface, result.repairs);
  drop_unused_points(surface);
  for (const auto& rim : open_rims(surface)) {
    result.ends.push_back(rim_end(surface, rim));
    result.rims.push_back(rim);
  }
  result.surface = std::move(surface);
  return result;
}

}  // namespace vasohex
