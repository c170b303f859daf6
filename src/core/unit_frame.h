// The unit cube normalisation of a scene.
#pragma once

#include <sdm/types.h>

namespace sdm::core {

/// Moves a scene to the cube [-1, 1]³ about the origin, so that single precision serves any placement and
/// size. The scale is a power of two: it adds no rounding.
struct UnitFrame {
  Vec3 origin{};
  double scale = 1;

  static UnitFrame of(const Box& box);
  [[nodiscard]] Vec3 to_unit(const Vec3& p) const {
    return {scale * (p[0] - origin[0]), scale * (p[1] - origin[1]), scale * (p[2] - origin[2])};
  }
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // the vocabulary of every folder
}
