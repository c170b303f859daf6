// The branch and bound over parts of A.
#pragma once

#include <span>
#include <vector>

#include "certify/hausdorff/lower_bound.h"
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
  /// What the evaluation of some parts results in.
  struct Found {
    LowerBound lower;
    std::vector<Part> open;
    double settled = 0;
  };

  /// `coordinate` is the largest of A. `lower` is raised.
  PartSearch(const sites::SitesData& b, double precision, double coordinate, LowerBound& lower)
      : b_(b), precision_(precision), coordinate_(coordinate), lower_(lower) {}

  /// Returns the upper bound. It is farther than the precision from the lower bound only if parts were
  /// divided to the precision of double.
  double operator()(const Mesh& a, std::span<const VertexDistance> vertices, const Progress& progress);

  void evaluate(std::span<const Part> run, Found& found) const;
  void learn(std::span<const Part> run, const Found& found);
  void conclude(std::span<const Part> run, const Found& found);

 private:
  void evaluate(const Part& part, Found& found) const;
  void put(Part part, Found& found) const;
  [[nodiscard]] double rounding(const Part& part) const;

  const sites::SitesData& b_;
  const double precision_, coordinate_;
  LowerBound& lower_;
  search::Parts<Part, Found> parts_;
};

}  // namespace sdm::hausdorff
