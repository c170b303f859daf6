// What the verdicts on a surface and on its groups share.
#pragma once

#include <sdm/verdict.h>

#include <cstdint>
#include <optional>
#include <span>

#include "certify/hausdorff/matching.h"

namespace sdm::summary {

/// Certifies verdicts of the samples of a map, on the whole surface or on groups of its faces. One thread.
class Certifier {
 public:
  using Faces = std::optional<std::span<const std::uint32_t>>;

  /// `surface`: the mesh of a Surface. Meshes, sites and map must outlive it. The error bound of the options
  /// has no meaning here.
  Certifier(const Mesh& surface, const Sites& sites, const DistanceMap& map, const CertifyOptions& options)
      : surface_(surface), sites_(sites), map_(map), options_(options) {}

  /// Returns the verdict, or where it leaves open what a proof may decide, that of the proof: of distances to
  /// the closest point, and to the faces that face the same way. What is measured otherwise, and limits of
  /// the latter that depend on signs, the samples judge alone. Where walls are thin, a pass by the closest
  /// points needs the other proof. `faces`: of the group; all, if there is none.
  [[nodiscard]] CertifiedVerdict operator()(const ToleranceVerdict& verdict, const Faces& faces = {});

  /// Replaces a verdict by that of the largest places. Where walls are thin, it leaves a pass in doubt.
  void decide_by_places(CertifiedVerdict& verdict, const PlaceDecision& places);

 private:
  [[nodiscard]] std::optional<ToleranceProof> prove(const Tolerance& tolerance, std::optional<double> facing,
                                                    const hausdorff::Matching* matching, const Faces& faces);
  void decide_by_facing(CertifiedVerdict& verdict, const Faces& faces);
  void leave_in_doubt(CertifiedVerdict& verdict) const;
  [[nodiscard]] Tolerance real_limits(const Tolerance& tolerance) const;
  [[nodiscard]] bool are_walls_thin(const Tolerance& tolerance);
  [[nodiscard]] const hausdorff::Matching& matching(double angle);
  [[nodiscard]] const hausdorff::Matching& reversed_matching(double angle);

  const Mesh& surface_;
  const Sites& sites_;
  const DistanceMap& map_;
  CertifyOptions options_;
  std::optional<Box> box_;                                  // of O2, as the next one made by the first proof
  std::optional<hausdorff::Matching> matching_, reversed_;  // if they are needed
  std::optional<bool> has_outside_;                         // the surface
};

/// Decides what thin walls leave open of a cloud, by the evidence of its distances to the faces that face the
/// same way, if its points have normals; otherwise a pass is doubtful, unless doubts are accepted.
void decide_thin_walls(CertifiedVerdict& verdict, const std::optional<Evidence>& by_facing,
                       bool accept_doubts);

}  // namespace sdm::summary
