// Points that descend through candidate lists together: packets of sixteen, and balls around packets and
// groups of packets.
#pragma once

#include <sdm/types.h>

#include <cmath>
#include <span>
#include <vector>

#include "geometry/unit_frame.h"
#include "tree/aabb_tree.h"

namespace sdm::closest {

/// A ball in the unit frame of O2, in single precision.
struct Ball {
  float centre[3];
  float radius;
};

/// Level 0 has one ball per packet. Each ball of a higher level covers kFan balls of the level below, up to
/// one ball for all.
struct PointGroup {
  static constexpr std::size_t kPacket = 16, kFan = 4;
  static constexpr int kLevels = 7;
  static constexpr std::size_t points_at(int level) { return kPacket << (2 * level); }
  static constexpr std::size_t kMostPoints = kPacket << (2 * (kLevels - 1));

  std::size_t packets = 0;
  int top = 0;                                 ///< the level of the single ball
  alignas(64) float position[3][kMostPoints];  ///< of the points; the last one is repeated to fill its packet
  std::vector<Ball> balls[kLevels];
  std::vector<tree::FloatBox> boxes;  ///< bounding boxes of the points of a level's balls, for place()

  /// Sets the group to 1 to kMostPoints points, mapped into the frame. Balls are small if the points are in
  /// an order like that of geometry/spatial_order.h. Up to rounding, they contain their points and the balls
  /// below them. Points that are far away are moved to the frame's origin; returns whether there are any.
  bool place(std::span<const Vec3> points, const UnitFrame& frame);

  /// Beyond this multiple of O2's size, squares approach the range of single precision.
  static bool far_away(const Vec3& unit_point) {
    return !(std::abs(unit_point[0]) < kFarAway && std::abs(unit_point[1]) < kFarAway &&
             std::abs(unit_point[2]) < kFarAway);
  }
  static constexpr double kFarAway = 1e15;
};

}  // namespace sdm::closest
