#include "vasohex/quality/quality_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "vasohex/quality/scaled_jacobian.h"
#include "vasohex/quality/skewness.h"

namespace vasohex {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Part `fraction` of the values lies below, interpolated between ranks.
double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) {
    return kNone;
  }
  const double rank = fraction * static_cast<double>(values.size() - 1);
  const auto below = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), below, values.end());
  const double low = *below;
  if (below + 1 == values.end()) {
    return low;
  }
  const double high = *std::min_element(below + 1, values.end());
  return low + (rank - std::floor(rank)) * (high - low);
}

double mean_of(const std::vector<double>& values) {
  return values.empty() ? kNone
                        : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

QualityFigures quality_figures(const std::vector<double>& values) {
  return {values.empty() ? kNone : *std::min_element(values.begin(), values.end()), percentile(values, 0.01),
          mean_of(values)};
}

DefectFigures defect_figures(const std::vector<double>& values) {
  return {values.empty() ? kNone : *std::max_element(values.begin(), values.end()), percentile(values, 0.99),
          mean_of(values)};
}

Vec3 mean_corner(const HexMesh& mesh, int element) {
  const std::size_t p = mesh.order, n = p + 1;
  Vec3 sum = Vec3::Zero();
  for (std::size_t c = 0; c < 8; ++c) {
    const std::size_t at = p * ((c & 1) + n * ((c >> 1 & 1) + n * (c >> 2)));
    sum += mesh.nodes[mesh.elements[element * n * n * n + at]];
  }
  return sum / 8;
}

}  // namespace

QualityReport measure_quality(const HexMesh& mesh, const Run& run) {
  QualityReport r;
  r.element_scaled_jacobian = scaled_jacobian(mesh.order, mesh.family, mesh.nodes, mesh.elements, run);
  r.element_scaled_jacobian_linear = scaled_jacobian_linear(mesh.order, mesh.nodes, mesh.elements, run);
  r.element_skewness = skewness(mesh.order, mesh.nodes, mesh.elements, run);
  r.element_validity = certify(mesh, run);

  r.scaled_jacobian = quality_figures(r.element_scaled_jacobian);
  r.scaled_jacobian_linear = quality_figures(r.element_scaled_jacobian_linear);
  r.skewness = defect_figures(r.element_skewness);
  r.bound_min = r.element_validity.empty() ? kNone : r.element_validity[0].bound;
  for (const Validity& v : r.element_validity) {
    ++(v.state == ValidityState::certified ? r.certified
       : v.state == ValidityState::invalid ? r.invalid
                                           : r.undecided);
    r.bound_min = std::min(r.bound_min, v.bound);
  }

  std::vector<int> ranking(r.element_scaled_jacobian.size());
  std::iota(ranking.begin(), ranking.end(), 0);
  const auto tenth = ranking.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(10, ranking.size()));
  std::partial_sort(ranking.begin(), tenth, ranking.end(), [&](int a, int b) {
    const double qa = r.element_scaled_jacobian[a], qb = r.element_scaled_jacobian[b];
    return qa < qb || (qa == qb && a < b);
  });
  for (auto e = ranking.begin(); e != tenth; ++e) {
    QualityReport::Element worst{*e, r.element_scaled_jacobian[*e], mean_corner(mesh, *e), {}, {}};
    if (!mesh.element_block.empty()) {
      worst.block = mesh.element_block[*e];
    }
    if (!mesh.element_branch.empty()) {
      worst.branch = mesh.element_branch[*e];
    }
    r.worst.push_back(worst);
  }
  return r;
}

}  // namespace vasohex
