#pragma once
/// \file Quality of a whole mesh.

#include <optional>
#include <vector>

#include "vasohex/mesh/hex_mesh.h"
#include "vasohex/quality/validity.h"

namespace vasohex {

/// Statistics of a measure that is good when large. Percentiles are interpolated linearly between ranks; NaN if there
/// are no elements.
struct QualityFigures {
  double min = 0;
  double p1 = 0;  ///< 1 % of the elements are worse
  double mean = 0;
};

/// Statistics of a measure that is good when small.
struct DefectFigures {
  double max = 0;
  double p99 = 0;  ///< 1 % of the elements are worse
  double mean = 0;
};

struct QualityReport {
  struct Element {
    int element = 0;
    double scaled_jacobian = 0;
    Vec3 centre = Vec3::Zero();  ///< mean of the corners
    std::optional<int> block;    ///< empty if the mesh does not know
    std::optional<int> branch;   ///< as HexMesh::element_branch
  };

  QualityFigures scaled_jacobian;         ///< of the curved elements
  QualityFigures scaled_jacobian_linear;  ///< of the straight-sided elements
  DefectFigures skewness;
  int certified = 0;
  int invalid = 0;
  int undecided = 0;
  double bound_min = 0;        ///< least Validity::bound; NaN if there are no elements
  std::vector<Element> worst;  ///< at most ten, least scaled Jacobian of the curved element first

  // the measures themselves, [elements]
  std::vector<double> element_scaled_jacobian;
  std::vector<double> element_scaled_jacobian_linear;
  std::vector<double> element_skewness;
  std::vector<Validity> element_validity;
};

/// Measures every element; see scaled_jacobian.h, skewness.h and validity.h for definitions and errors.
QualityReport measure_quality(const HexMesh& mesh, const Run& run = {});

}  // namespace vasohex
