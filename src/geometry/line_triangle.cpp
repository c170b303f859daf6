#include "geometry/line_triangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/exact_integer.h"
#include "geometry/rounding.h"

namespace sdm::core {
namespace {

using Integers = std::array<Integer, 3>;

struct ExactLine {
  Integers direction, corner[3];  // corners from the origin
  int unit;                       // of the ratio corner / direction: a power of two

  ExactLine(const Vec3& origin, const Vec3& d, const Corners& corners) {
    int length = std::numeric_limits<int>::max(), step = length;
    const auto include = [](int& exponent, double x) {
      if (x != 0) exponent = std::min(exponent, exponent_of(x));
    };
    for (std::size_t k = 0; k < 3; ++k) {
      include(step, d[k]);
      include(length, origin[k]);
      for (const Vec3& p : corners) include(length, p[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      direction[k] = in_units(d[k], step);
      for (std::size_t i = 0; i < 3; ++i)
        corner[i][k] = in_units(corners[i][k], length) - in_units(origin[k], length);
    }
    // If all are 0, so are all parameters.
    unit = length == std::numeric_limits<int>::max() ? 0 : length - step;
  }
};

Integer minor(const Integers& a, const Integers& b, std::size_t k) {
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  return a[i] * b[j] - a[j] * b[i];
}

Integer determinant(const Integers& a, const Integers& b, const Integers& c) {
  return a[0] * minor(b, c, 0) + a[1] * minor(b, c, 1) + a[2] * minor(b, c, 2);
}

// x ≈ mantissa · 2^exponent, by its first 64 bits.
struct Leading {
  double mantissa;
  int exponent;

  explicit Leading(const Integer& x) : mantissa(0), exponent(0) {
    if (x.is_zero()) return;
    const Integer magnitude = abs(x);
    exponent = std::max(0, static_cast<int>(msb(magnitude)) - 63);
    mantissa = static_cast<double>(static_cast<std::uint64_t>(magnitude >> exponent));
    if (x.sign() < 0) mantissa = -mantissa;
  }
};

double ratio(const Integer& above, const Integer& below, int unit) {
  const Leading a(above), b(below);
  return std::ldexp(a.mantissa / b.mantissa, a.exponent - b.exponent + unit) + 0.0;  // not -0
}

// The component of a vector of largest magnitude, the first of several.
template <class Vector>
std::size_t largest_component(const Vector& v) {
  using std::abs;
  std::size_t largest = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (abs(v[k]) > abs(v[largest])) largest = k;
  return largest;
}

// The line lies in the plane of the triangle, or meets the line of a triangle without area. Nonzero cross
// products of the direction and a corner are then parallel: a component of them is the side of the line on
// which the corner lies.
std::optional<LineHit> meet_in_plane(const ExactLine& line) {
  const std::size_t along = largest_component(line.direction);
  Integers side;
  for (std::size_t k = 0; k < 3 && side[0].is_zero() && side[1].is_zero() && side[2].is_zero(); ++k)
    for (std::size_t i = 0; i < 3; ++i) side[i] = minor(line.direction, line.corner[i], k);
  std::optional<LineHit> hit;
  const auto add = [&](double t) {
    hit = hit ? LineHit{std::min(hit->first, t), std::max(hit->last, t)} : LineHit{t, t};
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (side[i].is_zero()) add(ratio(line.corner[i][along], line.direction[along], line.unit));
    if (side[i].sign() * side[j].sign() < 0)
      add(ratio(side[i] * line.corner[j][along] - side[j] * line.corner[i][along],
                (side[i] - side[j]) * line.direction[along], line.unit));
  }
  return hit;
}

// The corner at which two sides of a triangle meet that the line passes through: the sides 0, 1, 2 are
// opposite to their corners. Nothing unless there are two.
std::optional<std::size_t> corner_between(const std::array<bool, 3>& sides) {
  if (sides[0] + sides[1] + sides[2] != 2) return std::nullopt;
  return !sides[0] ? 0 : !sides[1] ? 1 : 2;
}

std::optional<LineHit> meet_exactly(const Vec3& origin, const Vec3& direction, const Corners& corners) {
  const ExactLine line(origin, direction, corners);
  Integer volume = 0;
  bool left = false, right = false;
  std::array<bool, 3> through{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Integer edge = determinant(line.direction, line.corner[(k + 1) % 3], line.corner[(k + 2) % 3]);
    through[k] = edge.is_zero();
    left |= edge.sign() > 0;
    right |= edge.sign() < 0;
    volume += edge;
  }
  if (left && right) return std::nullopt;
  if (!left && !right) return meet_in_plane(line);
  if (const auto corner = corner_between(through)) {
    const std::size_t k = largest_component(line.direction);
    const double t = ratio(line.corner[*corner][k], line.direction[k], line.unit);
    return LineHit{t, t};
  }
  const double t = ratio(determinant(line.corner[0], line.corner[1], line.corner[2]), volume, line.unit);
  return LineHit{t, t};
}

// a·(b × c), and the sum of the magnitudes of its terms.
struct Determinant {
  double value = 0, magnitude = 0;

  Determinant(const Vec3& a, const Vec3& b, const Vec3& c) {
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const double plus = b[i] * c[j], minus = b[j] * c[i];
      value += a[k] * (plus - minus);
      magnitude += std::abs(a[k]) * (std::abs(plus) + std::abs(minus));
    }
  }
  // Whether each term has a factor of 0, and all are exact then: a difference of numbers is 0 only of equal
  // ones.
  static bool vanishes(const Vec3& a, const Vec3& b, const Vec3& c) {
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      if (a[k] != 0 && ((b[i] != 0 && c[j] != 0) || (b[j] != 0 && c[i] != 0))) return false;
    }
    return true;
  }
  [[nodiscard]] bool certain() const { return std::abs(value) > kError3 * magnitude + kUnderflow; }
};

// The parameter of a corner that the line passes through; nothing if the difference to the origin rounds. The
// same number as of meet_exactly().
std::optional<LineHit> meet_corner(const Vec3& origin, const Vec3& direction, const Vec3& corner) {
  const std::size_t k = largest_component(direction);
  const double difference = corner[k] - origin[k], back = corner[k] - difference;
  if (back != origin[k] || (back + difference != corner[k])) return std::nullopt;
  const double t = difference / direction[k] + 0.0;  // not -0
  return LineHit{t, t};
}

}  // namespace

// The line passes each side of the triangle to the left, to the right, or through it: the sign of
// direction·(b × c) with corners b and c seen from the origin. It meets the triangle if no two signs are
// opposite. Both triangles at an edge compute the same sign for it, since it is exact: no line passes between
// them.
std::optional<LineHit> line_meets_triangle(const Vec3& origin, const Vec3& direction,
                                           const Corners& corners) {
  const auto& [a, b, c] = corners;
  const Vec3 from[3] = {a - origin, b - origin, c - origin};
  bool left = false, right = false, certain = true;
  std::array<bool, 3> through{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &first = from[(k + 1) % 3], &second = from[(k + 2) % 3];
    const Determinant edge(direction, first, second);
    if (edge.certain()) {
      (edge.value > 0 ? left : right) = true;
    } else {
      certain = false;
      through[k] = Determinant::vanishes(direction, first, second);
    }
  }
  if (left && right) return std::nullopt;
  // Where meshes share a grid, lines from vertices of the one pass through those of the other.
  if (left || right)
    if (const auto corner = corner_between(through))
      if (const auto hit = meet_corner(origin, direction, corners[*corner])) return hit;
  if (!certain) return meet_exactly(origin, direction, corners);

  // t = n·(a − origin) / n·direction with n = (b − a) × (c − a), unless much of n·direction cancels.
  constexpr double kMostCancelled = 1 << 10;
  const Vec3 u = b - a, v = c - a;
  const Determinant height(from[0], u, v), speed(direction, u, v);
  double magnitude = 0, fastest = 0;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    magnitude += std::abs(u[i] * v[j]) + std::abs(u[j] * v[i]);
    fastest = std::max(fastest, std::abs(direction[k]));
  }
  if (!height.certain() || magnitude * fastest > kMostCancelled * std::abs(speed.value))
    return meet_exactly(origin, direction, corners);
  const double t = height.value / speed.value;
  return LineHit{t, t};
}

}  // namespace sdm::core
