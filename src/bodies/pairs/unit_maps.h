// The maps between the unit frames of two meshes, in single precision.
#pragma once

#include "bodies/pairs/mesh_pair.h"

namespace sdm::pairs {

/// A map into one unit frame from the other.
struct FrameMap {
  float row[3][3], offset[3];
  float stretch;  ///< an upper bound on the length of a mapped unit vector
  float error;    ///< bound on the error of mapped coordinates, and of their differences and extents; if
                  ///< infinite, the map gives no bound
};

/// A direction in space, given in both frames: along[0]·x1 + along[1]·x2 + offset is the extent in this
/// direction from a point x1 in the frame of O1 to a point x2 in the frame of O2, in the unit of O1's frame.
struct Direction {
  bool known = false;
  float along[2][3] = {}, offset = 0;
};

/// Lengths are compared in a common unit in which the larger mesh has a size of about 1.
struct UnitMaps {
  FrameMap to[2];  ///< into the frame of O1, and of O2
  float unit[2];   ///< lower bounds on the units of these frames, in the common unit
  bool aligned;    ///< both frames have the same axes, so boxes of one are boxes of the other

  explicit UnitMaps(const MeshPair& pair);

  /// Converts a length of O1, rounded up by more than the rounding error of a norm.
  [[nodiscard]] float round_up(double length) const;

  /// A bound on the rounding error of distances of triangles in double precision, as a length of O1: it grows
  /// with their coordinates, and with the distance itself.
  [[nodiscard]] double rounding() const { return rounding_; }

  /// The direction of a vector; not known if the vector is zero.
  [[nodiscard]] Direction direction(const Vec3& vector) const;

 private:
  double scale_, rounding_;
};

}  // namespace sdm::pairs
