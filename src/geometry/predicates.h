// Exact orientation predicates.
#pragma once

#include <sdm/types.h>

namespace sdm::core {

/// The sign of (d − a)·((b − a) × (c − a)): 1 if a, b, c are counter-clockwise seen from d, −1 if they are
/// clockwise, 0 if d lies in their plane or they are collinear. Exact for all finite coordinates. Cost: about
/// twenty operations; big integers only where rounding could change the sign.
[[nodiscard]] int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The sign of (b − a) × (c − a): 1 if c is to the left of the line from a to b. Exact.
[[nodiscard]] int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
