// The side of a plane or a line that a point is on, decided exactly.
#pragma once

#include <sdm/types.h>

namespace sdm::core {

/// The sign of (d − a)·((b − a) × (c − a)): 1 where d is above the plane of a, b, c, that is where these run
/// counter-clockwise seen from d; −1 below it; 0 on it, and where they lie on a line. Exact for all finite
/// coordinates. Cost: some twenty operations; big integers only where rounding could change the sign.
[[nodiscard]] int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The sign of (b − a) × (c − a): 1 where c is to the left of the line from a to b. Exact.
[[nodiscard]] int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

}  // namespace sdm::core

namespace sdm {
using namespace core;  // the vocabulary of every folder
}
