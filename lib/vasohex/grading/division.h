#pragma once
/// \file How an edge is divided: laws on [0,1].

#include <functional>
#include <optional>
#include <variant>
#include <vector>

namespace vasohex {

/// Equal parts.
struct UniformLaw {};

/// Each part `growth` times as long as the one before it. growth > 0.
struct GeometricLaw {
  double growth = 1.2;
};

/// Parts that shrink towards both ends by a hyperbolic tangent: stretching > 0, the more the stronger.
struct TanhLaw {
  double stretching = 2.0;
};

/// The user's: increasing on [0,1], 0 at 0, 1 at 1.
struct CustomLaw {
  std::function<double(double)> position;
};

using Law = std::variant<UniformLaw, GeometricLaw, TanhLaw, CustomLaw>;

/// Positions 0 = t[0] < ... < t[count] = 1. Throws Error(bad_input) where the law gives none.
std::vector<double> divide(const Law& law, int count);

/// Whether the law reads the same from both ends.
bool is_symmetric(const Law& law, int count);

/// Layers along the wall.
struct WallLayers {
  int layers = 5;
  double first_height = 0.05;  ///< of the layer at the wall
  bool relative = true;        ///< heights in units of the local radius, else in those of the mesh
  double growth = 1.2;         ///< each layer to the one before it
};

/// Distances from the wall, of a line of length `length` with `count` > layers parts: 0 = d[0] < ... < d[count] =
/// length. The layers first, then parts that grow or shrink geometrically from the last layer to fill the rest.
/// Layers that would take more than 0.75 of the line, or nearly, grow less; only where even equal ones do not fit the
/// first one is thinner too. All is a smooth function of the length: a kink would bend the elements of order > 1 that
/// it runs through. \param first height of the first layer, same unit as `length`. \param shrunk set to whether the
/// line is too short.
std::vector<double> divide_wall_line(const WallLayers& layers, double first, int count, double length, bool& shrunk);

}  // namespace vasohex
