#pragma once
/// \file The cases of junction_survey.

#include <optional>
#include <string>
#include <vector>

#include "vasohex/skeleton/skeleton.h"

namespace vasohex::survey {

/// One table each.
enum class Kind { random, nasty, named, trees };
const std::vector<Kind>& all_kinds();
std::string name_of(Kind kind);

struct Case {
  Kind kind = Kind::random;
  std::string group;  ///< `k3` of `k3/17`; named cases: empty
  std::string name;   ///< unique: `k3/17` is seed 17 of the random junctions of 3 branches
  Skeleton skeleton;
  double goal = 0;  ///< of the least scaled Jacobian; named cases: of the straight-sided one
};

/// All cases of a kind; `count` cuts their seeds: so many networks and junctions of 3 to 5 branches, a quarter of
/// that of those of 6 to 8, which take far longer. Deterministic. The published junction of six branches is among
/// them if the environment's VASOHEX_DATA is its folder.
std::vector<Case> cases_of(Kind kind, std::optional<int> count);

}  // namespace vasohex::survey
