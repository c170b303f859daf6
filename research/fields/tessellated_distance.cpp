#include "research/fields/tessellated_distance.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sdm::fields {
namespace {

// Of the largest distance.
constexpr double kLeastError = 1e-6;

// Two unit vectors normal to a unit vector and to each other.
std::array<Vec3, 2> normal_plane(const Vec3& axis) {
  const Vec3 other = std::abs(axis[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 first = normalized(cross(axis, other));
  return {first, cross(axis, first)};
}

}  // namespace

// Half of the error is that of the sectors: a chord at the radius r comes within r cos(π/n) of the centre,
// where it is drawn with the distance of r, so the error is at most r (1 / cos(π/n) − 1), with n sectors. A
// radius differs from the distance of a vertex by less than that, as √(r² + h²) is 1-Lipschitz in r.
TessellatedDistance::TessellatedDistance(double error, double largest) : error_(error), largest_(largest) {
  if (!(error >= kLeastError * largest))
    throw Error(
        "the error of tessellation is below 10^-6 of the largest distance, too small for single precision");
  const double half_sector = std::acos(1 / (1 + 0.5 * error / largest));
  const auto count = static_cast<std::size_t>(std::max(3.0, std::ceil(std::numbers::pi / half_sector)));
  const double angle = 2 * std::numbers::pi / static_cast<double>(count);
  directions_.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double at = angle * static_cast<double>(k), stretch = 1 / std::cos(0.5 * angle);
    directions_[k] = {stretch * std::cos(at), stretch * std::sin(at)};
  }
}

double TessellatedDistance::radius(double x, double y) const {
  const auto count = static_cast<double>(directions_.size());
  const double turn = std::atan2(y, x) / (2 * std::numbers::pi);  // in [−½, ½]
  const auto k = static_cast<std::size_t>(std::round(count * (turn + 1))) % directions_.size();
  return std::max(0.0, directions_[k][0] * x + directions_[k][1] * y);
}

// The other half of the error is that of the rings: the second derivative of f(r) = √(r² + h²) is h² / f³,
// which decreases, so that interpolation from r to r + d has an error of at most d² f″(r) / 8.
void TessellatedDistance::place_rings(double height) {
  rings_.assign(1, 0.0);
  if (height <= 0.5 * error_) {  // the cone with the tip at that height
    rings_.push_back(2 * largest_);
    return;
  }
  while (rings_.back() < largest_) {
    const double r = rings_.back(), f = std::hypot(r, height);
    rings_.push_back(r + std::sqrt(4 * error_ * f * f * f) / height);
  }
}

double TessellatedDistance::hyperboloid(double r, double height) const {
  const auto above = std::ranges::upper_bound(rings_, r);
  if (above == rings_.end()) return std::hypot(r, height);  // beyond the largest distance
  const double inner = above[-1], outer = *above, t = (r - inner) / (outer - inner);
  return (1 - t) * std::hypot(inner, height) + t * std::hypot(outer, height);
}

void TessellatedDistance::draw_span(float* squared, std::uint32_t* winner, std::size_t count,
                                    const SpanVector& vector, const DrawnSite& site) {
  // An edge without a direction, which is too short for one, is drawn as a vertex.
  const bool vertex = site.region.axis == Vec3{};
  const auto [right, up] =
      vertex ? std::array<Vec3, 2>{{{1, 0, 0}, {0, 1, 0}}} : normal_plane(site.region.axis);
  const double height = vertex ? std::abs(double{vector.start[2]}) : 0;
  if (vertex) place_rings(height);
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 v;
    for (int k = 0; k < 3; ++k)
      v[k] = double{vector.start[k]} + static_cast<double>(i) * double{vector.step[k]};
    const double r = radius(dot(v, right), dot(v, up));
    const double distance = vertex ? hyperboloid(r, height) : r;
    const auto drawn = static_cast<float>(distance * distance);
    if (drawn < squared[i]) {
      squared[i] = drawn;
      winner[i] = site.code;
    }
  }
}

}  // namespace sdm::fields
