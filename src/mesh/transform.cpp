#include <sdm/error.h>
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/affine.h"
#include "geometry/predicates.h"
#include "geometry/vec.h"

namespace sdm {
namespace {

// Counter-clockwise about the axis, seen from its tip.
Transform rotation_about(int axis, double degrees) {
  const double turn = std::remainder(degrees, 360), radians = turn * (std::numbers::pi / 180);
  const double s = std::abs(turn) == 180 ? 0 : std::sin(radians);
  const double c = std::abs(turn) == 90 ? 0 : std::cos(radians);
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  Transform map;
  map.rows[i][i] = map.rows[j][j] = c;
  map.rows[i][j] = -s;
  map.rows[j][i] = s;
  return map;
}

// The exponent of the power of two that scales the largest component to between 1/2 and 1; 0 for a zero.
int largest_exponent(const Vec3& v) {
  int exponent = 0;
  (void)std::frexp(std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}), &exponent);
  return exponent;
}

Vec3 scaled(const Vec3& v, int exponent) {
  return {std::ldexp(v[0], exponent), std::ldexp(v[1], exponent), std::ldexp(v[2], exponent)};
}

}  // namespace

Transform Transform::translation(const Vec3& offset) {
  Transform map;
  for (int k = 0; k < 3; ++k) map.rows[k][3] = offset[k];
  return map;
}

Transform Transform::scaling(double factor) {
  Transform map;
  for (int k = 0; k < 3; ++k) map.rows[k][k] = factor;
  return map;
}

Transform Transform::rotation(const Vec3& degrees) {
  return rotation_about(2, degrees[2]) * rotation_about(1, degrees[1]) * rotation_about(0, degrees[0]);
}

Transform Transform::quaternion(const std::array<double, 4>& wxyz) {
  const auto& [w, x, y, z] = wxyz;
  const double squared = w * w + x * x + y * y + z * z, s = 2 / squared;
  if (!(squared > 0 && std::isfinite(squared) && std::isfinite(s)))
    throw Error("a quaternion of a rotation must be finite and not zero");
  Transform map;
  const double linear[3][3] = {{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
                               {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
                               {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}};
  for (int i = 0; i < 3; ++i) std::ranges::copy(linear[i], map.rows[i].begin());
  return map;
}

Vec3 Transform::operator()(const Vec3& p) const {
  Vec3 result;
  for (int k = 0; k < 3; ++k)
    result[k] = rows[k][0] * p[0] + rows[k][1] * p[1] + rows[k][2] * p[2] + rows[k][3];
  return result;
}

Vec3 Transform::normal(const Vec3& n) const {
  // M⁻ᵀ n is parallel to sign(det M) C n, C the cofactors of M. With M = D M', D the powers of two that scale
  // the rows of M' to about 1, M⁻ᵀ = D⁻¹ M'⁻ᵀ, so that no product overflows or vanishes.
  const int side = orientation();
  if (side == 0 || !finite(n)) return {};
  std::array<Vec3, 3> row;
  std::array<int, 3> exponent;
  for (int k = 0; k < 3; ++k) {
    row[k] = {rows[k][0], rows[k][1], rows[k][2]};
    exponent[k] = largest_exponent(row[k]);
    row[k] = scaled(row[k], -exponent[k]);
  }
  const Vec3 m = scaled(n, -largest_exponent(n));
  Vec3 result{dot(cross(row[1], row[2]), m), dot(cross(row[2], row[0]), m), dot(cross(row[0], row[1]), m)};
  const int least = std::ranges::min(exponent);
  for (int k = 0; k < 3; ++k) result[k] = side * std::ldexp(result[k], least - exponent[k]);
  return normalized(scaled(result, -largest_exponent(result)));
}

Transform Transform::inverse() const {
  Affine map;
  for (int i = 0; i < 3; ++i) {
    map.rows[i] = {rows[i][0], rows[i][1], rows[i][2]};
    map.offset[i] = rows[i][3];
  }
  const Affine back = core::inverse(map);
  Transform result;
  bool is_finite = orientation() != 0 && finite(back.offset);
  for (int i = 0; i < 3; ++i) {
    is_finite = is_finite && finite(back.rows[i]);
    for (int j = 0; j < 3; ++j) result.rows[i][j] = back.rows[i][j];
    result.rows[i][3] = back.offset[i];
  }
  if (!is_finite) throw Error("a transform that is singular, or nearly so, has no inverse");
  return result;
}

double Transform::determinant() const {
  const auto row = [&](int k) { return Vec3{rows[k][0], rows[k][1], rows[k][2]}; };
  return dot(row(0), cross(row(1), row(2)));
}

int Transform::orientation() const {
  const auto row = [&](int k) { return Vec3{rows[k][0], rows[k][1], rows[k][2]}; };
  return core::orientation({}, row(0), row(1), row(2));
}

Transform operator*(const Transform& a, const Transform& b) {
  Transform product;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      product.rows[i][j] = 0;
      for (int k = 0; k < 4; ++k) product.rows[i][j] += a.rows[i][k] * b.rows[k][j];
    }
  return product;
}

Transform fit_to_unit(const Mesh& mesh) {
  const Box box = bounds(mesh);
  const Vec3 size = box.upper - box.lower;
  const double longest = std::max({size[0], size[1], size[2]});
  if (!(longest > 0)) throw Error("fit_to_unit() requires a mesh with positive extent");
  return Transform::scaling(1 / longest) * Transform::translation(-centre(box));
}

void transform(std::span<Vec3> points, const Transform& map) {
  for (const Vec3& p : points)
    if (!finite(map(p))) throw Error("the transform produces an infinite coordinate; use smaller values");
  for (Vec3& p : points) p = map(p);
}

void transform(Mesh& mesh, const Transform& map) {
  transform(std::span(mesh.positions), map);
  if (map.orientation() >= 0) return;
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  for (auto& uv : mesh.corner_uvs) std::swap(uv[1], uv[2]);
}

}  // namespace sdm
