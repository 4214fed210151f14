#include "boundary_conditions.h"

#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "vasohex/core/error.h"
#include "vasohex/quality/quality_report.h"

namespace vasohex::stokes {
namespace {

[[noreturn]] void fail(const std::string& message) { throw Error(ErrorCode::bad_input, message); }

void check_elements(const HexMesh& mesh) {
  const QualityReport quality = measure_quality(mesh);
  const int bad = quality.invalid + quality.undecided;
  if (bad > 0) {
    const Vec3& x = quality.worst.front().centre;
    fail(std::to_string(bad) + " of " + std::to_string(mesh.element_count()) +
         " elements are not certified, the worst at (" + std::to_string(x.x()) + ", " + std::to_string(x.y()) + ", " +
         std::to_string(x.z()) + "): no flow can be computed on inverted elements; mend the mesh first");
  }
}

/// The surfaces of each connected part of the mesh.
std::vector<std::set<int>> parts(const HexMesh& mesh) {
  const int n = mesh.nodes_per_element();
  std::vector<int> parent(mesh.nodes.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) {
      i = parent[i] = parent[parent[i]];
    }
    return i;
  };
  for (std::size_t i = 0; i < mesh.elements.size(); ++i) {
    parent[root(mesh.elements[i])] = root(mesh.elements[i - i % n]);
  }
  std::map<int, std::set<int>> surfaces;
  for (int e = 0; e < mesh.element_count(); ++e) {
    surfaces[root(mesh.elements[e * n])];
  }
  for (const HexMesh::BoundaryFace& face : mesh.boundary) {
    surfaces[root(mesh.elements[face.element * n])].insert(face.surface);
  }
  std::vector<std::set<int>> result;
  for (const auto& [node, of_part] : surfaces) {
    result.push_back(of_part);
  }
  return result;
}

std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

/// The flow of each inlet.
std::map<std::string, double> inflows(const MeshInfo& info, const BoundaryConditions& conditions) {
  std::map<std::string, double> flows = conditions.flows;
  std::vector<std::string> without;
  for (const BoundaryInfo& b : info.boundaries) {
    if (b.role == BoundaryRole::inlet && !flows.count(b.name)) {
      without.push_back(b.name);
    }
  }
  if (without.size() > 1 || (!without.empty() && !flows.empty() && !conditions.flow_rate)) {
    fail("no flow for " + list(without) + ": with several inlets each needs its own, as --flow " + without[0] +
         "=Q; a flow of 0 closes it");
  }
  if (without.empty() && conditions.flow_rate) {
    fail("--flow-rate: there is no inlet left that it could be for; flows by name are given with --flow");
  }
  if (without.empty() && flows.empty()) {
    fail("there is no inlet: name an end with its flow into the mesh, as --flow " +
         (info.boundaries.size() > 1 ? info.boundaries[1].name : "NAME") + "=Q");
  }
  if (!without.empty()) {
    const double r = info.boundary(without[0]).radius;
    flows[without[0]] = conditions.flow_rate.value_or(std::numbers::pi * r * r * r / (4 * conditions.viscosity));
  }
  return flows;
}

}  // namespace

std::vector<End> flow_ends(const HexMesh& mesh, const MeshInfo& info, const BoundaryConditions& conditions) {
  check_elements(mesh);
  const std::map<std::string, double> flows = inflows(info, conditions);
  for (const auto* named : {&flows, &conditions.resistances}) {
    for (const auto& [name, value] : *named) {
      if (info.boundary(name).role == BoundaryRole::wall) {
        fail("'" + name + "' is the wall, not an end");
      }
    }
  }
  std::vector<End> ends;
  std::set<std::string> with_flow, without_flow;
  for (const BoundaryInfo& b : info.boundaries) {
    if (b.role == BoundaryRole::wall) {
      continue;
    }
    End end{b.id, b.name, dealii::Tensor<1, 3>({b.normal.x(), b.normal.y(), b.normal.z()}), b.radius, {}, 0};
    if (const auto q = flows.find(b.name); q != flows.end()) {
      end.flow = q->second;
    }
    if (const auto r = conditions.resistances.find(b.name); r != conditions.resistances.end()) {
      if (end.flow) {
        fail("end " + b.name + " has a flow and a resistance: only one of them can be given");
      }
      end.resistance = r->second;
    }
    (end.flow ? with_flow : without_flow).insert(b.name);
    ends.push_back(end);
  }
  const std::vector<std::set<int>> components = parts(mesh);
  for (const std::set<int>& surfaces : components) {
    std::vector<std::string> names;
    bool in = false, out = false;
    for (const int s : surfaces) {
      in |= with_flow.count(mesh.surfaces[s]) > 0;
      out |= without_flow.count(mesh.surfaces[s]) > 0;
      if (info.boundaries[s].role != BoundaryRole::wall) {
        names.push_back(mesh.surfaces[s]);
      }
    }
    if (!in || !out) {
      const std::string what = components.size() == 1 ? "the mesh"
                                                      : "one of the " + std::to_string(components.size()) +
                                                            " unconnected parts of the mesh";
      fail(what + " has no " + (in ? "outlet, an end without a given flow" : "inlet with a flow") +
           "; its ends: " + (names.empty() ? "none" : list(names)));
    }
  }
  return ends;
}

}  // namespace vasohex::stokes
