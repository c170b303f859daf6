// The unit frames of two meshes, seen from each other in single precision.
#pragma once

#include "proximity/exact/mesh_pair.h"

namespace sdm::exact {

/// Into one unit frame from the other.
struct FrameMap {
  float row[3][3], offset[3];
  float error;  ///< of a coordinate mapped, and of differences and extents of coordinates there; if infinite
                ///< the map tells nothing
};

/// A direction of space, seen from both frames: along[0]·x1 + along[1]·x2 + offset is how far a point x2 in
/// the frame of O2 lies from x1 in the frame of O1 in this direction, in the unit of O1's frame.
struct Direction {
  bool known = false;
  float along[2][3] = {}, offset = 0;
};

/// Lengths are compared in one unit: the larger mesh is about 1 long.
struct UnitMaps {
  FrameMap to[2];  ///< into the frame of O1, and of O2
  float unit[2];   ///< what lengths measured in these frames come to, at least
  bool aligned;    ///< the axes of both frames are the same: either sees the other's boxes as they are

  explicit UnitMaps(const MeshPair& pair);

  /// A length of O1, rounded up by more than rounding takes from a norm.
  [[nodiscard]] float round_up(double length) const;

  /// The direction of a vector; not known if that is zero.
  [[nodiscard]] Direction direction(const Vec3& vector) const;

 private:
  double scale_;
};

}  // namespace sdm::exact
