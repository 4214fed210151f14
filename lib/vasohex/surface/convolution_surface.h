#pragma once
/// \file Internal to surface/: the level function of convolved cones that blend at joints.

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "vasohex/surface/blending.h"
#include "vasohex/surface/cone_kernel.h"
#include "vasohex/surface/cone_tree.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

/// What one piece, or a blend of pieces, contributes at a point.
struct ConeSum {
  double value = 0;              ///< F
  Vec3 gradient = Vec3::Zero();  ///< of F
};

/// See make_convolution_surface.
class ConvolutionSurface final : public ImplicitSurface {
 public:
  ConvolutionSurface(std::vector<ConeSegment> segments, std::shared_ptr<const Blending> blending);

  double value(const Vec3& x) const override;
  double value(const Vec3& x, Vec3& gradient) const override;
  bool is_round() const override { return true; }
  double radius(const Vec3& x) const override;
  std::shared_ptr<const ImplicitSurface> part(const std::vector<Stretch>& stretches) const override;

  /// The level of `piece` and what blends with it, as if there were no other vessels. Beyond its reach the level
  /// there and no gradient.
  double value_of_piece(int piece, const Vec3& x, Vec3& gradient) const;

 private:
  /// What a piece contributes at a point.
  struct PieceSum : ConeSum {
    int piece = 0;
  };
  class PieceSums;

  PieceSums gather(const Vec3& x) const;
  bool is_greatest_of(std::span<const PieceSum> sums, std::size_t i, int joint) const;
  void separate_siblings(std::span<const PieceSum> sums, int joint, const ConeSum& greatest, const Vec3& x,
                         ConeSum& others) const;
  template <bool with_gradient>
  ConeSum blended(std::span<const PieceSum> sums, int joint, const ConeSum& greatest, const Vec3& x) const;
  template <bool with_gradient>
  double evaluate(const Vec3& x, Vec3* gradient) const;

  std::vector<ConeSegment> segments_;           ///< ascending by piece
  std::vector<std::ptrdiff_t> first_of_piece_;  ///< [pieces + 1]
  ConeTree tree_;
  std::shared_ptr<const Blending> blending_;
};

}  // namespace vasohex
