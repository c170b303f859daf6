// The branch and bound over parts of A.
#pragma once

#include <span>
#include <vector>

#include "certify/hausdorff/lower_bound.h"
#include "certify/hausdorff/part.h"
#include "certify/hausdorff/vertex_search.h"

namespace sdm::hausdorff {

/// Finds bounds on the largest distance from a point of A to B. A part whose bound is above the lower bound
/// plus the precision is *open*. Each open part is evaluated at the point where its bound is attained: the
/// distance there may raise the lower bound, and the face found there lowers the bound of the part, unless it
/// is known already; then the part is divided. Parts with the highest bounds are evaluated first, many at a
/// time.
class PartSearch {
 public:
  /// `coordinate` is the largest of A. `lower` is raised.
  PartSearch(const sites::SitesData& b, double precision, double coordinate, LowerBound& lower)
      : b_(b), precision_(precision), coordinate_(coordinate), lower_(lower) {}

  void start(const Mesh& a, std::span<const VertexDistance> vertices);

  /// Evaluates parts until none is open, and returns the upper bound. It is farther than the precision from
  /// the lower bound only if parts were divided to the precision of double.
  double finish(const Progress& progress);

 private:
  /// What the evaluation of some parts results in.
  struct Outcome {
    LowerBound lower;
    std::vector<Part> open;
    double settled = 0;
  };

  std::size_t choose_batch();
  void evaluate(std::span<const Part> parts, Outcome& outcome) const;
  void evaluate(const Part& part, Outcome& outcome) const;
  void put(Part part, Outcome& outcome) const;
  [[nodiscard]] double rounding(const Part& part) const;

  const sites::SitesData& b_;
  const double precision_, coordinate_;
  LowerBound& lower_;
  std::vector<Part> open_;
  double settled_ = 0;  // bound on the distance in all parts that are not open
};

}  // namespace sdm::hausdorff
