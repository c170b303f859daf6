#include "certify/hausdorff/largest_distance.h"

#include <sdm/error.h>
#include <sdm/hausdorff.h>
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <utility>

#include "certify/hausdorff/first_parts.h"
#include "certify/hausdorff/matching.h"
#include "certify/hausdorff/part_search.h"
#include "certify/hausdorff/vertex_search.h"
#include "closest/facing/facing_normals.h"
#include "core/memory.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "sites/sites_data.h"

namespace sdm::hausdorff {
namespace {

double largest_coordinate(const Box& box) {
  double largest = 0;
  for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(box.lower[k]), std::abs(box.upper[k])});
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

namespace sdm {
namespace {

double area(const Mesh& mesh, std::uint32_t face) {
  const auto [a, b, c] = corners_of(mesh, face);
  return norm(cross(b - a, c - a)) / 2;
}

/// States what was left out. Throws if that is all.
void report_unmatched(const Mesh& a, const hausdorff::LargestDistance& found, HausdorffDistance& result) {
  if (found.lower.faces[0] == kNone)
    throw Error(
        "no face of the measured surface has one of the other surface that faces the same way, within the "
        "angle: there is no distance");
  result.faces_without_match = found.unmatched.size();
  if (found.unmatched.empty()) return;
  double without = 0, all = 0;
  for (const std::uint32_t face : found.unmatched) without += area(a, face);
  for (std::uint32_t face = 0; face < a.triangles.size(); ++face)
    if (!is_removed(a.triangles[face])) all += area(a, face);
  result.area_without_match = std::min(1.0, without / all);
}

HausdorffDistance bound_distance(const Mesh& a, const sites::SitesData& b, const HausdorffOptions& options) {
  const hausdorff::Scale scale = hausdorff::scale_of(a, bounds(b.mesh));
  const double asked = options.precision.value_or(HausdorffOptions::kPrecision * scale.size);
  std::optional<hausdorff::Matching> matching;
  if (options.facing)
    matching.emplace(b, *options.facing, facing::facing_normals(a, *options.facing).normals);
  const hausdorff::LargestDistance found = hausdorff::largest_distance(
      a, b, scale, {.precision = asked, .matching = matching ? &*matching : nullptr}, options.progress);
  const auto& [lower, upper, unmatched] = found;

  HausdorffDistance result{.faces = lower.faces};
  if (options.facing) report_unmatched(a, found, result);
  BoundedLength& distance = result.distance;
  distance.value = norm(lower.closest - lower.point);
  distance.lower = std::min(lower.value, distance.value);
  distance.upper = std::max(upper, distance.value);
  distance.certainty =
      distance.upper - distance.lower <= kDoubleRounding * scale.size ? Certainty::exact : Certainty::bounded;
  distance.witness = std::array{lower.point, lower.closest};
  return result;
}

}  // namespace

HausdorffDistance one_sided_hausdorff(const Mesh& a, const Sites& b, const HausdorffOptions& options) try {
  check_options(options);
  validate(a);
  return bound_distance(a, internals(b), options);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the Hausdorff distance");
}

SymmetricHausdorff symmetric_hausdorff(const Sites& a, const Sites& b, const HausdorffOptions& options) try {
  check_options(options);
  SymmetricHausdorff result{.from = {bound_distance(a.mesh(), internals(b), options),
                                     bound_distance(b.mesh(), internals(a), options)}};
  const BoundedLength &first = result.from[0].distance, &second = result.from[1].distance;
  result.larger_from = second.lower > first.lower ? 1 : 0;
  result.larger = result.from[result.larger_from];
  BoundedLength& larger = result.larger.distance;
  larger.upper = std::max(first.upper, second.upper);
  if (larger.upper > result.from[result.larger_from].distance.upper) larger.certainty = Certainty::bounded;
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the Hausdorff distance");
}

}  // namespace sdm
