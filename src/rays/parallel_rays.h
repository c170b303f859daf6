// Whether parallel rays from points near each other meet O2: one search of the tree for up to 64 of them.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sites/sites_data.h"
#include "tree/wide_tree.h"

namespace sdm::rays {

/// The corners of the faces of O2 in the unit frame, by the leaves of the tree. The sites must outlive it.
class LeafCorners {
 public:
  /// Cost: linear, all cores.
  explicit LeafCorners(const sites::SitesData& sites);

  struct Leaf {
    static constexpr int kWidth = tree::WideTree::kWidth;
    alignas(32) float at[3][3][kWidth];   ///< of corners, axes, faces
    alignas(32) float normal[3][kWidth];  ///< outward, of length 1; 0 unless O2 is a solid, and of slivers
    std::uint32_t face[kWidth];
    std::uint32_t count;
  };
  const sites::SitesData& sites;
  std::vector<Leaf> leaves;
};

/// Points of O2, each slightly above the outer side of a face.
struct RayOrigins {
  static constexpr std::size_t kMost = 64;

  std::size_t count = 0;
  std::array<Vec3, kMost> point;
  std::array<std::uint32_t, kMost> face;  ///< that no ray from the point meets
  /// Must be called when all of these are set.
  void place(const UnitFrame& frame);

  std::array<float, 3> centre, half;     ///< their box in the unit frame
  alignas(64) float at[3][kMost];        ///< relative to the centre; after the last point, repeats it
  alignas(64) std::uint32_t own[kMost];  ///< `face` of each of them
  /// A bit for each origin that is known to have the winding number 0: of a solid, every ray from it that
  /// meets a face enters through one.
  std::uint64_t outside = 0;
};

/// Sets a bit of `outside` for each origin in `active` whose ray shows that; the direction has length 1. None
/// unless O2 is a solid. Dispatches at run time to the best vector instructions of the machine.
void find_outside(const LeafCorners& faces, RayOrigins& origins, const Vec3& direction, std::uint64_t active,
                  std::vector<std::uint32_t>& stack);

/// A bit for each origin in `active` from which the ray in a direction of length 1, away from its own face,
/// meets O2 within `max_distance`, as sdm::occluded() has it. Dispatches at run time to the best vector
/// instructions of the machine.
[[nodiscard]] std::uint64_t occluded(const LeafCorners& faces, const RayOrigins& origins,
                                     const Vec3& direction, double max_distance, std::uint64_t active,
                                     std::vector<std::uint32_t>& stack);

}  // namespace sdm::rays
