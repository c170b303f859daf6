#include "scenes/made_scan.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <random>

#include "geometry/vec.h"
#include "scenes/divide_edges.h"
#include "scenes/rotation.h"

namespace sdm::scenes {
namespace {

std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3 n =
        cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
    for (const std::uint32_t v : t) normals[v] += n;
  }
  for (Vec3& n : normals) n = normalized(n);
  return normals;
}

struct FlatPlace {
  Vec3 point{}, normal{};
  double radius = 0;
};

/// The vertex, of a sample, around which the mesh stays longest in a plane. A ball of the radius around it
/// contains nothing else, so that the body is thicker than that.
FlatPlace flattest_place(const Mesh& mesh, const std::vector<Vec3>& normals, double size) {
  constexpr std::size_t kCandidates = 400;
  const double kFlat = 1e-3 * size;
  FlatPlace best;
  const std::size_t stride = std::max<std::size_t>(1, mesh.positions.size() / kCandidates);
  for (std::size_t i = 0; i < mesh.positions.size(); i += stride) {
    const Vec3 &p = mesh.positions[i], &n = normals[i];
    double nearest = size * size;  // the squared distance of a vertex out of the plane
    for (const Vec3& q : mesh.positions)
      if (const Vec3 d = q - p; squared_norm(d) < nearest && std::abs(dot(d, n)) > kFlat)
        nearest = squared_norm(d);
    if (nearest > best.radius * best.radius) best = {p, n, std::sqrt(nearest)};
  }
  return best;
}

/// Numbers of a normal distribution, the same with every standard library: by Box and Muller.
class Normal {
 public:
  double operator()() {
    const double u = 1 - uniform(), v = uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }

 private:
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  std::mt19937_64 random_{1};
};

/// Removes the faces that are farthest along the longest side of the box, away from `keep`, with `fraction`
/// of the area, and the vertices of no other face. Returns the fraction removed.
double cut_end(Mesh& mesh, const Box& box, const Vec3& keep, double fraction) {
  const Vec3 size = box.upper - box.lower;
  const auto axis = static_cast<std::size_t>(std::ranges::max_element(size) - size.begin());
  const double away = keep[axis] > centre(box)[axis] ? -1 : 1;
  std::vector<double> along, areas;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    along.push_back(away * (a[axis] + b[axis] + c[axis]));
    areas.push_back(norm(cross(b - a, c - a)));
  }
  std::vector<std::uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::uint32_t face) { return std::pair(-along[face], face); });
  const double all = std::accumulate(areas.begin(), areas.end(), 0.0);
  double removed = 0;
  std::size_t first = 0;
  while (first < order.size() && removed < fraction * all) removed += areas[order[first++]];

  std::vector<std::uint32_t> left(order.begin() + static_cast<std::ptrdiff_t>(first), order.end());
  std::ranges::sort(left);
  Mesh rest;
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);
  for (const std::uint32_t face : left) {
    Triangle& t = rest.triangles.emplace_back(mesh.triangles[face]);
    for (std::uint32_t& v : t) {
      if (number[v] == kNone) {
        number[v] = static_cast<std::uint32_t>(rest.positions.size());
        rest.positions.push_back(mesh.positions[v]);
      }
      v = number[v];
    }
  }
  mesh = std::move(rest);
  return removed / all;
}

/// Turned about an oblique axis through the middle of the box, then moved in an oblique direction.
Transform tilt_and_shift(const Box& box, double degrees, double length) {
  const Matrix turn = rotation_about({0.48, 0.6, 0.64}, degrees / 180 * std::numbers::pi);
  const Vec3 middle = centre(box), to = middle + length * Vec3{0.6, -0.64, 0.48} - turn * middle;
  Transform result;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      result.rows[row][column] = column < 3 ? turn[column][row] : to[row];
  return result;
}

}  // namespace

MadeScan make_scan(const Mesh& part, const ScanOptions& options) {
  const Box box = bounds(part);
  MadeScan scan{.mesh = divide_edges(part, options.triangles), .size = diagonal(box)};
  const std::vector<Vec3> normals = vertex_normals(scan.mesh);
  const FlatPlace place = flattest_place(scan.mesh, normals, scan.size);
  scan.dent_place = place.point;
  scan.dent_depth = options.dent * scan.size;
  scan.dent_radius = std::min(place.radius, 0.1 * scan.size);
  scan.noise = options.noise * scan.size;
  if (!(scan.dent_radius > 3 * scan.dent_depth)) throw Error("the part has no flat place for a dent");

  Normal normal;
  for (std::size_t i = 0; i < scan.mesh.positions.size(); ++i) {
    Vec3& p = scan.mesh.positions[i];
    const double rest = 1 - squared_norm(p - place.point) / (scan.dent_radius * scan.dent_radius);
    p += (scan.noise * normal()) * normals[i];
    if (rest > 0) p += (-scan.dent_depth * rest * rest) * place.normal;
  }
  scan.missing = cut_end(scan.mesh, box, place.point, options.missing);
  scan.placement = tilt_and_shift(box, options.tilt, options.shift * scan.size);
  transform(scan.mesh, scan.placement);
  return scan;
}

}  // namespace sdm::scenes
