// Charts: sets of faces that are laid out together.
#pragma once

#include <sdm/types.h>

#include <vector>

namespace sdm::atlas {

/// Faces that share one orthogonal projection along `axis`, with normal·axis ≥ cos θ > 0 for every one of
/// them; or two adjacent faces of which the second is unfolded into the plane of the first, normal to `axis`.
struct Chart {
  Vec3 axis{};
  std::vector<std::uint32_t> faces;  ///< in increasing order
  bool unfolded = false;
};

}  // namespace sdm::atlas
