// What the verdicts on a surface and on its groups share.
#pragma once

#include <sdm/certified_verdict.h>

namespace sdm::summary {

/// Returns the verdict, or where it leaves open what a proof may decide, that of the proof. Proofs are about
/// the closest point: what is `measured` otherwise, its samples judge.
[[nodiscard]] CertifiedVerdict certify(const ToleranceVerdict& verdict, const Mesh& surface,
                                       const Sites& sites, DistanceKind measured,
                                       const ToleranceProofOptions& options);

/// The samples of a set that have no value, and whether one of them has none for want of a match, which is
/// the reason then, rather than since its match is beyond the maximum distance.
class WithoutValue {
 public:
  explicit WithoutValue(const DistanceMap& map) : map_(map) {}
  void add_texel(std::uint32_t texel) {
    (map_.unmatched.empty() || map_.unmatched[texel] == 0 ? beyond_ : unmatched_) = true;
  }
  void add_vertex() { vertex_ = true; }

  [[nodiscard]] bool any() const { return unmatched_ || beyond_ || vertex_; }
  /// Vertices do not say what they lack: they count as the texels of the set or, if these have values, of the
  /// map.
  [[nodiscard]] bool unmatched() const {
    if (unmatched_ || beyond_ || !vertex_ || map_.measured.kind == DistanceKind::closest) return unmatched_;
    return map_.without_match > 0 || map_.beyond_max_distance == 0;
  }

 private:
  const DistanceMap& map_;
  bool unmatched_ = false, beyond_ = false, vertex_ = false;
};

}  // namespace sdm::summary
