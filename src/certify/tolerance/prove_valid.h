// The proof of a tolerance for meshes that were validated before.
#pragma once

#include <sdm/tolerance_proof.h>

namespace sdm::tolerance {

/// prove_tolerance() of a surface that is usable, as those of a Surface are: the cost is by the faces that
/// matter, so that there may be many proofs for parts of a surface.
[[nodiscard]] ToleranceProof prove_valid(const Mesh& surface, const Sites& sites, const Tolerance& tolerance,
                                         const ToleranceProofOptions& options);

}  // namespace sdm::tolerance
