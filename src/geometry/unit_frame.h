// Normalisation of a scene to the unit cube.
#pragma once

#include <sdm/types.h>

#include <algorithm>

namespace sdm::core {

/// Maps a scene into the cube [-1, 1]³, so that single precision suffices for any placement and size. The
/// scale is a power of two, so scaling does not round.
struct UnitFrame {
  Vec3 origin{};
  double scale = 1;

  static UnitFrame of(const Box& box);
  [[nodiscard]] Vec3 to_unit(const Vec3& p) const {
    return {scale * (p[0] - origin[0]), scale * (p[1] - origin[1]), scale * (p[2] - origin[2])};
  }
  /// A distance of the scene in the unit frame, rounded up: nothing that is within it is farther there than
  /// this and the error of the distance as it is computed. Its square is finite.
  [[nodiscard]] float unit_limit(double distance) const {
    return static_cast<float>(std::min(1.00001 * distance * scale, 1e18));
  }
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
