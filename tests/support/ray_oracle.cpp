#include "support/ray_oracle.h"

#include <boost/multiprecision/cpp_int.hpp>

#include <vector>

namespace sdm::oracle {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Vector = std::array<Rational, 3>;

Vector operator-(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Rational dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
bool zero(const Vector& a) {
  return a[0] == 0 && a[1] == 0 && a[2] == 0;
}
Vector exact(const Vec3& a) {
  return {Rational(a[0]), Rational(a[1]), Rational(a[2])};
}

struct Line {
  Vector origin, direction;

  [[nodiscard]] Vector at(const Rational& t) const {
    return {origin[0] + t * direction[0], origin[1] + t * direction[1], origin[2] + t * direction[2]};
  }
};

// The parameters of the ends of what the line has in common with a segment.
void add_segment(const Line& line, const Vector& a, const Vector& b, std::vector<Rational>& t) {
  const Vector side = b - a, normal = cross(line.direction, side), to = a - line.origin;
  const Rational squared = dot(line.direction, line.direction);
  if (zero(normal)) {  // parallel, or a point
    if (!zero(cross(to, line.direction))) return;
    t.push_back(dot(to, line.direction) / squared);
    t.push_back(dot(b - line.origin, line.direction) / squared);
    return;
  }
  if (dot(to, normal) != 0) return;  // skew
  const Rational square = dot(normal, normal);
  const Rational along = dot(cross(to, line.direction), normal) / square;
  if (along >= 0 && along <= 1) t.push_back(dot(cross(to, side), normal) / square);
}

}  // namespace

std::optional<RayInTriangle> ray_in_triangle(const Vec3& origin, const Vec3& direction,
                                             const std::array<Vec3, 3>& corners) {
  const Line line{exact(origin), exact(direction)};
  const Vector p[3] = {exact(corners[0]), exact(corners[1]), exact(corners[2])};
  const Vector normal = cross(p[1] - p[0], p[2] - p[0]);
  const Rational speed = dot(normal, line.direction), height = dot(normal, p[0] - line.origin);
  std::vector<Rational> t;
  if (speed != 0) {
    const Rational at = height / speed;
    const Vector x = line.at(at);
    for (int k = 0; k < 3; ++k)
      if (dot(cross(p[(k + 1) % 3] - p[k], x - p[k]), normal) < 0) return std::nullopt;
    t.push_back(at);
  } else if (zero(normal) || height == 0) {
    for (int k = 0; k < 3; ++k) add_segment(line, p[k], p[(k + 1) % 3], t);
  }
  if (t.empty()) return std::nullopt;
  Rational first = t[0], last = t[0];
  for (const Rational& x : t) {
    if (x < first) first = x;
    if (x > last) last = x;
  }
  if (last < 0) return std::nullopt;
  if (first < 0) first = 0;
  return RayInTriangle{first.convert_to<double>(), last.convert_to<double>()};
}

}  // namespace sdm::oracle
