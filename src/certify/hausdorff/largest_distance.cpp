#include "certify/hausdorff/largest_distance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "certify/hausdorff/matched_parts.h"
#include "certify/hausdorff/part_search.h"
#include "certify/hausdorff/vertex_search.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"

namespace sdm::hausdorff {
namespace {

double largest_coordinate(const Box& box) {
  double largest = 0;
  for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(box.lo[k]), std::abs(box.hi[k])});
  return largest;
}

}  // namespace

Scale scale_of(const Mesh& a, const Box& box) {
  const Box of_a = bounds(a);
  Box both = box;
  extend(both, of_a);
  const double size = diagonal(both);
  return {size, largest_coordinate(of_a), kDoubleRounding * std::max(size, largest_coordinate(both))};
}

LargestDistance largest_distance(const Mesh& a, const sites::SitesData& b, const Scale& scale,
                                 const Question& question, const Progress& progress) {
  LargestDistance result{.lower = {.side = question.side}};
  LowerBound& lower = result.lower;
  if (question.decision) lower.value = question.decision->limit;
  const double precision = std::max(question.precision, scale.precision);
  PartSearch parts(
      b, {precision, scale.coordinate, question.decision, question.most_parts, question.matching}, lower);
  if (question.matching != nullptr) {
    MatchedParts first =
        matched_parts(a, b, *question.matching, precision, question.decision.has_value(), progress, lower);
    result.unmatched = std::move(first.unmatched);
    result.upper = parts(first, progress);
  } else {
    const auto vertices = search_vertices(a, b, progress, lower);
    result.upper = parts(a, vertices, progress);
  }
  return result;
}

}  // namespace sdm::hausdorff
