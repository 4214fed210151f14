#pragma once
/// \file What is measured of a case, and its tables.

#include <string>
#include <vector>

#include "survey_cases.h"
#include "vasohex/vasohex.h"

namespace vasohex::survey {

/// Figures of one case at one order.
struct Figures {
  const Case* subject = nullptr;
  int order = 0;
  std::string error;       ///< why there is no mesh; empty: there is one, and the following are set
  int elements = 0;        ///< in the mesh
  int faulty = 0;          ///< elements that are not certified
  int faulty_blocks = 0;   ///< the same of blocks
  int unconverged = 0;     ///< wall nodes that are not on the surface
  double min = 0;          ///< least scaled Jacobian of the curved elements
  std::string worst;       ///< where the least is: vessel or junction, position
  double linear_min = 0;   ///< least scaled Jacobian of the straight-sided elements
  double block_min = 0;    ///< least scaled Jacobian of the blocks, before the walls are projected onto the surface
  double cpu_seconds = 0;  ///< processor time of the junctions' optimisation, all together
  int junctions = 0;
  int loops = 0;          ///< all cases are of one component
  double candidates = 0;  ///< arrangements tried, mean over the junctions

  bool certified() const { return error.empty() && faulty + faulty_blocks == 0; }
  /// What the case's goal is compared with.
  double measured() const { return subject->kind == Kind::named ? linear_min : min; }
  /// Goals of named cases are of meshes of order 1: blocks are then made for straight edges.
  double goal() const { return subject->kind == Kind::named && order > 1 ? 0.0 : subject->goal; }
  bool good() const { return certified() && unconverged == 0 && measured() >= goal(); }
};

/// Meshes a case with one thread and measures it; never throws vasohex::Error. The mesh is also left in `mesh`, if
/// given.
Figures measure(const Case& subject, int order, SkeletonMesh* mesh = nullptr);

/// Title, text, table and list of what falls short, in Markdown. The figures are of one kind, in the order of the
/// cases and by order within a case.
std::string table(Kind kind, const std::vector<Figures>& figures);

/// One line per case that falls short of its goal or is not certified: name, order, figures.
std::string shortfalls(const std::vector<Figures>& figures);

/// An array of all figures, in their order.
std::string json(const std::vector<Figures>& figures);

}  // namespace vasohex::survey
