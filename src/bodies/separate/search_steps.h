// Steps of searches for the shortest translation apart, of two bodies and of several pairs.
#pragma once

#include <sdm/proximity_query.h>

#include <cstdint>

#include "bodies/convex/convex_mesh.h"
#include "bodies/separate/moved_pair.h"
#include "bodies/shape/posed_body.h"

namespace sdm::separate {

inline constexpr double kExact = 1e-6;      // of the size: bounds that are as close are exact
inline constexpr double kClose = 0.98;      // ratio of bounds at which a search ends
inline constexpr double kLeastGap = 1e-12;  // of the size, beyond a translation after which bodies touch

/// The point of a body that is farthest along u, in space. `convex`: the body, if it is a convex solid, whose
/// `vertex` is one that is near; it receives that vertex.
[[nodiscard]] Vec3 farthest(const shape::PosedBody& body, const convex::ConvexMesh* convex, const Vec3& u,
                            std::uint32_t& vertex);

/// A translation without a collision, by a little more along u than one after which the bodies touch at most.
[[nodiscard]] Vec3 beyond(TranslatedBodies& bodies, const Vec3& translation, const Vec3& u, double size);

/// The result with a lower bound, which may be below 0, and a translation that was verified.
[[nodiscard]] SeparatingTranslation bounded_translation(double lower, const Vec3& translation, double size);

/// Calls work for the directions along the axes of a cube, and its diagonals.
template <class Work>
void for_each_direction(const Work& work) {
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0) work(normalized(Vec3{1.0 * x, 1.0 * y, 1.0 * z}));
}

}  // namespace sdm::separate
