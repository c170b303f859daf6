#include "mesh/similarity.h"

#include <sdm/error.h>

#include <cmath>

#include "geometry/rounding.h"

namespace sdm::mesh {
namespace {

Vec3 product(const std::array<Vec3, 3>& rows, const Vec3& v) {
  return v[0] * rows[0] + v[1] * rows[1] + v[2] * rows[2];
}

/// R Rᵀ, of which the identity is a fixed point.
std::array<Vec3, 3> gram(const std::array<Vec3, 3>& r) {
  std::array<Vec3, 3> result;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) result[i][j] = dot(r[i], r[j]);
  return result;
}

}  // namespace

Similarity Similarity::of(const Transform& pose) {
  constexpr double kTolerance = 1e-5;
  Similarity result;
  bool finite = pose.rows[3] == std::array<double, 4>{0, 0, 0, 1};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.map.rows[i][j] = pose.rows[i][j];
    result.map.offset[i] = pose.rows[i][3];
    finite = finite && std::isfinite(squared_norm(result.map.rows[i])) && std::isfinite(result.map.offset[i]);
  }
  std::array<Vec3, 3>& r = result.map.rows;
  const double determinant = pose.determinant();
  result.scale = std::abs(determinant - 1) < 2e-12 ? 1 : std::cbrt(determinant);
  if (std::abs(result.scale - 1) < 1e-12) result.scale = 1;  // rounding
  double error = finite && result.scale > 0 && std::isfinite(result.scale) ? 0 : 1;
  if (error == 0) {
    if (result.scale != 1)
      for (Vec3& row : r) row = (1 / result.scale) * row;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) error = std::max(error, std::abs(dot(r[i], r[j]) - (i == j ? 1 : 0)));
  }
  if (!(error <= kTolerance)) throw Error("a pose is not a rotation with a uniform scale and a translation");
  // Newton's iteration towards the nearest rotation, R ← (3 I − R Rᵀ) R / 2, squares the error.
  for (; error > kFewRoundings; error *= error) {
    std::array<Vec3, 3> g = gram(r);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) g[i][j] = 0.5 * ((i == j ? 3 : 0) - g[i][j]);
    r = {product(r, g[0]), product(r, g[1]), product(r, g[2])};
  }
  if (result.scale != 1)
    for (Vec3& row : r) row = result.scale * row;
  return result;
}

Transform Similarity::transform() const {
  Transform result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.rows[i][j] = map.rows[i][j];
    result.rows[i][3] = map.offset[i];
  }
  return result;
}

}  // namespace sdm::mesh
