// Charts: sets of faces that are laid out together.
#pragma once

#include <sdm/types.h>

#include <vector>

namespace sdm::atlas {

/// Faces that share one orthogonal projection along `axis`; normal·axis ≥ cos θ > 0 for every one of them.
struct Chart {
  Vec3 axis{};
  std::vector<std::uint32_t> faces;  ///< in increasing order
};

}  // namespace sdm::atlas
