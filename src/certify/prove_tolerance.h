// The proof of a tolerance for meshes that were validated before.
#pragma once

#include <sdm/tolerance.h>

#include "certify/hausdorff/matching.h"

namespace sdm::tolerance {

/// Returns the faces that count with ToleranceProofOptions::facing, for any number of proofs. Their normals
/// are outward, which those of a part of a solid would not be. Throws sdm::Error for an angle out of range.
/// Cost: O(n log n) in the faces of the surface and linear in those of O2.
[[nodiscard]] hausdorff::Matching matching_of(const Mesh& surface, const Sites& sites, double angle);

/// Data of all proofs of a surface and O2.
struct Known {
  Box box;                                ///< of O2
  const hausdorff::Matching* matching{};  ///< with options.facing: that of matching_of()
};

/// prove_tolerance() of a surface that is usable, as those of a Surface are: the cost is by the faces that
/// matter, so that there may be many proofs for parts of a surface.
[[nodiscard]] ToleranceProof prove_valid(const Mesh& surface, const Sites& sites, const Tolerance& tolerance,
                                         const ToleranceProofOptions& options, const Known& known);

}  // namespace sdm::tolerance
