// The faces of B that the points of a face of A are measured to, if not all.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "closest/exact.h"
#include "closest/facing/facing_search.h"

namespace sdm::hausdorff {

/// Allows the faces of B that face the same way as a face of A, within an angle. The distance to those of one
/// face is that to a fixed set, and so 1-Lipschitz on the face: as a function on all of A it jumps from face
/// to face.
class Matching {
 public:
  /// `normals`: of the faces of A, unit length or 0. Cost: linear in the faces of B. Throws sdm::Error for an
  /// angle out of range.
  Matching(const sites::SitesData& b, double angle, std::vector<Vec3> normals)
      : b_(b),
        rule_(std::make_shared<const Rule>(Rule{facing::FacingSearch(b, angle), std::move(normals)})) {}

  /// Returns that of a part of A, face f of which is faces[f] of A. `faces` must outlive it. Cost: O(1).
  [[nodiscard]] Matching of_part(std::span<const std::uint32_t> faces) const {
    Matching part = *this;
    part.faces_ = faces;
    return part;
  }

  /// Whether a face of A has a normal: those without area have no points of their own.
  [[nodiscard]] bool has_normal(std::uint32_t face) const { return normal(face) != Vec3{}; }
  [[nodiscard]] bool allows(std::uint32_t face, std::uint32_t other) const {
    return rule_->search.allows(normal(face), other);
  }
  /// Whether there may be an allowed face below a node of B's tree.
  [[nodiscard]] bool may_allow(std::uint32_t face, std::uint32_t node) const {
    return rule_->search.may_allow(node, normal(face));
  }
  /// The allowed faces, if they are few: as FacingSearch::few_allowed().
  [[nodiscard]] std::optional<std::vector<std::uint32_t>> few_allowed(std::uint32_t face) const {
    return rule_->search.few_allowed(normal(face));
  }

  /// Whether a point of a face of A is behind the faces that it is measured to.
  [[nodiscard]] bool behind(std::uint32_t face, const Vec3& p) const {
    constexpr double kAnywhere = kInfinity;
    return rule_->search.match(p, normal(face), kAnywhere, closest::exact_closest(b_, p, kAnywhere)).behind;
  }

 private:
  struct Rule {
    facing::FacingSearch search;
    std::vector<Vec3> normals;
  };

  [[nodiscard]] const Vec3& normal(std::uint32_t face) const {
    return rule_->normals[faces_.empty() ? face : faces_[face]];
  }

  const sites::SitesData& b_;
  std::shared_ptr<const Rule> rule_;        // of all parts of A
  std::span<const std::uint32_t> faces_{};  // empty: all of A
};

}  // namespace sdm::hausdorff
