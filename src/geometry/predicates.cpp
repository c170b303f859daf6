#include "geometry/predicates.h"

#include <cmath>
#include <limits>

#include "core/numbers/double_double.h"
#include "geometry/exact_integer.h"

namespace sdm::core {
namespace {

int sign(double x) {
  return (x > 0) - (x < 0);
}

// The error of a determinant in DoubleDouble: differences are exact, and each term has four roundings of
// sums and two of products, less than 2⁻¹⁰⁰ of it together. Magnitudes of terms are in double precision.
constexpr double kErrorOfDoubled = 0x1p-99;

// The sign, or 0 if it is not certain.
int certain_sign(const DoubleDouble& determinant, double magnitude) {
  return std::abs(determinant.high) > kErrorOfDoubled * magnitude + kUnderflow ? sign(determinant.high) : 0;
}

// The sign of the determinant of the differences from a, in DoubleDouble; 0 if that is not certain.
int by_doubled(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double magnitude) {
  std::array<DoubleDouble, 3> u, v, w;
  for (int k = 0; k < 3; ++k) {
    u[k] = exact_sum(b[k], -a[k]);
    v[k] = exact_sum(c[k], -a[k]);
    w[k] = exact_sum(d[k], -a[k]);
  }
  const auto term = [&](int k, int i, int j) { return w[k] * (u[i] * v[j] - u[j] * v[i]); };
  return certain_sign(term(0, 1, 2) + term(1, 2, 0) + term(2, 0, 1), magnitude);
}
int by_doubled(const Vec2& a, const Vec2& b, const Vec2& c, double magnitude) {
  const auto from_a = [&](const Vec2& p, int k) { return exact_sum(p[k], -a[k]); };
  return certain_sign(from_a(b, 0) * from_a(c, 1) - from_a(b, 1) * from_a(c, 0), magnitude);
}

template <class Point, std::size_t count>
auto differences(const std::array<Point, count>& points) {
  constexpr std::size_t n = std::tuple_size_v<Point>;
  int exponent = std::numeric_limits<int>::max();
  for (const auto& p : points)
    for (const double x : p)
      if (x != 0) exponent = std::min(exponent, exponent_of(x));
  std::array<std::array<Integer, n>, count - 1> result;
  for (std::size_t i = 1; i < count; ++i)
    for (std::size_t k = 0; k < n; ++k)
      result[i - 1][k] = in_units(points[i][k], exponent) - in_units(points[0][k], exponent);
  return result;
}

int exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto [u, v, w] = differences(std::array{a, b, c, d});
  const Integer determinant = w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
                              w[2] * (u[0] * v[1] - u[1] * v[0]);
  return determinant.sign();
}

int exact(const Vec2& a, const Vec2& b, const Vec2& c) {
  const auto [u, v] = differences(std::array{a, b, c});
  const Integer determinant = u[0] * v[1] - u[1] * v[0];
  return determinant.sign();
}

}  // namespace

int OrientedPlane::side_by_more_digits(const Vec3& d, double magnitude) const {
  const Vec3 &a = a_, &b = b_, &c = c_;
  if (a == b || a == c || a == d || b == c || b == d || c == d) return 0;  // no volume
  for (int k = 0; k < 3; ++k)
    if (a[k] == b[k] && a[k] == c[k] && a[k] == d[k]) return 0;  // as in a flat part of a drawing
  if (const int found = by_doubled(a, b, c, d, magnitude); found != 0) return found;
  return exact(a, b, c, d);
}

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return OrientedPlane(a, b, c).side(d);
}

int orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 u = b - a, v = c - a;
  const double plus = u[0] * v[1], minus = u[1] * v[0];
  const double magnitude = std::abs(plus) + std::abs(minus);
  if (std::abs(plus - minus) > kError2 * magnitude + kUnderflow) return sign(plus - minus);
  if (a == b || a == c || b == c) return 0;  // no area
  for (int k = 0; k < 2; ++k)
    if (a[k] == b[k] && a[k] == c[k]) return 0;  // as in a flat part of a drawing, seen from the side
  if (const int found = by_doubled(a, b, c, magnitude); found != 0) return found;
  return exact(a, b, c);
}

}  // namespace sdm::core
