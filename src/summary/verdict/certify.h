// What the verdicts on a surface and on its groups share.
#pragma once

#include <sdm/certified_verdict.h>

namespace sdm::summary {

/// `surface`: the mesh of a Surface. Returns the verdict, or where it leaves open what a proof may decide,
/// that of the proof. Proofs are about the closest point: what is `measured` otherwise, its samples judge.
[[nodiscard]] CertifiedVerdict certify(const ToleranceVerdict& verdict, const Mesh& surface,
                                       const Sites& sites, DistanceKind measured,
                                       const ToleranceProofOptions& options);

}  // namespace sdm::summary
