// Points that descend through lists of sites together: packets of sixteen, and balls around them and around
// groups of packets.
#pragma once

#include <sdm/types.h>

#include <cmath>
#include <span>
#include <vector>

#include "hierarchy/aabb_tree.h"

namespace sdm::cpu {

/// In the unit frame of O2, in single precision.
struct Ball {
  float centre[3];
  float radius;
};

/// Level 0 has a ball for each packet; another level's balls each cover kFan of the level below, up to one
/// for all.
struct PointGroup {
  static constexpr std::size_t kPacket = 16, kFan = 4;
  static constexpr int kLevels = 7;
  static constexpr std::size_t points_at(int level) { return kPacket << (2 * level); }
  static constexpr std::size_t kMostPoints = kPacket << (2 * (kLevels - 1));

  std::size_t packets = 0;
  int top = 0;                                 ///< the level of the one ball
  alignas(64) float position[3][kMostPoints];  ///< of the points, the last one repeated to fill its packet
  std::vector<Ball> balls[kLevels];
  std::vector<hierarchy::FloatBox> boxes;  ///< of the points of each ball of a level, while they are placed

  /// The group of 1 to kMostPoints points, in the frame. Balls are small where the points come in an order
  /// like that of core/spatial_order.h. They contain their points, and the balls below them, but for
  /// rounding. Points that are far away are put at the frame's origin; returns whether there are any.
  bool place(std::span<const Vec3> points, const UnitFrame& frame);

  /// Beyond this multiple of O2's size, squares approach the range of single precision.
  static bool far_away(const Vec3& unit_point) {
    return !(std::abs(unit_point[0]) < kFarAway && std::abs(unit_point[1]) < kFarAway &&
             std::abs(unit_point[2]) < kFarAway);
  }
  static constexpr double kFarAway = 1e15;
};

}  // namespace sdm::cpu
