// What the verdicts on a surface and on its groups share.
#pragma once

#include <sdm/certified_verdict.h>

#include <cstdint>
#include <optional>
#include <span>

#include "certify/hausdorff/matching.h"

namespace sdm::summary {

/// Certifies verdicts of the samples of a map, on the whole surface or on groups of its faces. One thread.
class Certifier {
 public:
  /// `surface`: the mesh of a Surface. All must outlive it.
  Certifier(const Mesh& surface, const Sites& sites, const DistanceMap& map, double accuracy,
            const Progress& progress)
      : surface_(surface), sites_(sites), map_(map), accuracy_(accuracy), progress_(progress) {}

  /// Returns the verdict, or where it leaves open what a proof may decide, that of the proof: of distances to
  /// the closest point, and to the faces that face the same way. What is measured otherwise, and limits of
  /// the latter that depend on signs, the samples judge alone. `faces`: of the group; all, if there is none.
  [[nodiscard]] CertifiedVerdict operator()(const ToleranceVerdict& verdict,
                                            std::optional<std::span<const std::uint32_t>> faces = {});

 private:
  const Mesh& surface_;
  const Sites& sites_;
  const DistanceMap& map_;
  double accuracy_;
  const Progress& progress_;
  std::optional<Box> box_;                       // of O2, as the next one made by the first proof
  std::optional<hausdorff::Matching> matching_;  // if it is needed
};

}  // namespace sdm::summary
