#pragma once
/// \file A network's own frame: the same for a network however it was moved, turned or scaled.

#include "vasohex/skeleton/network.h"

namespace vasohex {

/// x = origin + scale * rotation * y for y in the frame.
struct OwnFrame {
  Vec3 origin = Vec3::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double scale = 1;

  Vec3 outward(const Vec3& y) const { return origin + scale * (rotation * y); }
  Vec3 inward(const Vec3& x) const { return rotation.transpose() * (x - origin) / scale; }
  /// The frame whose outward is this one's inward.
  OwnFrame inverse() const { return {inward(Vec3::Zero()), rotation.transpose(), 1 / scale}; }
};

/// The middle of all samples, the mean radius as length, axes towards the furthest sample and the one furthest from
/// that axis. A straight network leaves the turn about its axis open.
OwnFrame own_frame(const Network& network);

/// The network in the frame, its numbers rounded to 2^-28 (4e-9 mean radii): networks that differ by rounding alone
/// become the same to the last bit, and so does all that is made of them. Optimisation would magnify the difference.
Network in_frame(const Network& network, const OwnFrame& frame);

}  // namespace vasohex
