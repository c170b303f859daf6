// The branch and bound over parts of A.
#pragma once

#include <span>
#include <vector>

#include "certify/hausdorff/first_parts.h"
#include "certify/hausdorff/largest_distance.h"
#include "certify/hausdorff/part.h"
#include "certify/hausdorff/vertex_search.h"
#include "search/branch_and_bound.h"

namespace sdm::hausdorff {

/// Finds bounds on the largest distance from a point of A to B. Each open part is evaluated at the point
/// where its bound is attained: the distance there may raise the lower bound, and the face found there lowers
/// the bound of the part, unless it is known already; then the part is divided.
class PartSearch : public search::Policy {
 public:
  static constexpr std::size_t kLeast = 256, kFraction = 3;
  static constexpr std::size_t kRun = 16;  // each may profit from those before
  /// The result of the evaluation of some parts.
  struct Found {
    LowerBound lower;
    std::vector<FacePart> open;
    double settled = 0;
  };

  struct Limits {
    double precision, coordinate;  ///< of the bounds; the largest coordinate of A
    std::optional<Decision> decision{};
    std::size_t most_parts = std::numeric_limits<std::size_t>::max();
    const Matching* matching = nullptr;
  };

  /// `lower` is raised; with a decision, it is at least its limit.
  PartSearch(const sites::SitesData& b, const Limits& limits, LowerBound& lower)
      : b_(b),
        precision_(limits.precision),
        coordinate_(limits.coordinate),
        decision_(limits.decision),
        most_parts_(limits.most_parts),
        matching_(limits.matching),
        lower_(lower) {}

  /// Returns the upper bound. It is farther than the precision from the lower bound only if parts were
  /// divided to the precision of double, if the search ended at the decision, or after the most parts.
  double operator()(const Mesh& a, std::span<const VertexDistance> vertices, const Progress& progress);
  double operator()(const FirstParts& first, const Progress& progress);

  void evaluate(std::span<const FacePart> run, Found& found) const;
  void learn(std::span<const FacePart> run, const Found& found);
  void conclude(std::span<const FacePart> run, const Found& found);
  [[nodiscard]] bool within_budget() const {
    return examined_ < most_parts_ && !(decision_ && lower_.value > decision_->forgiven);
  }

 private:
  void evaluate(const FacePart& part, Found& found) const;
  void forgive();
  void put(FacePart part, Found& found) const;
  [[nodiscard]] double rounding(const FacePart& part) const;

  const sites::SitesData& b_;
  const double precision_, coordinate_;
  const std::optional<Decision> decision_;
  const std::size_t most_parts_;
  const Matching* matching_;  // null: all faces of B count
  LowerBound& lower_;
  std::size_t examined_ = 0;
  search::Parts<FacePart, Found> parts_;
};

}  // namespace sdm::hausdorff
