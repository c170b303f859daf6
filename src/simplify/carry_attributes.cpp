#include <sdm/closest_points.h>
#include <sdm/error.h>
#include <sdm/simplify.h>
#include <sdm/sites.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <new>
#include <utility>

#include "closest/facing/facing_normals.h"
#include "core/memory.h"
#include "geometry/barycentric.h"

namespace sdm {
namespace {

/// Where the corners of faces take their values: at a point of a face of the input. No face: nowhere.
struct Origin {
  std::uint32_t face = kNone;
  Vec3 weights{};
};

// The face is the closest one to a point of the face that is near the corner: where values jump at an edge of
// the input, each face gets those of its side. Where the corner is off the surface, on which the other skin
// of a thin wall may be closer, only faces count that face as its face does. The weights are those of the
// corner itself: exactly one corner's at a vertex of the input.
std::vector<Origin> origins_of(const Sites& sites, const Mesh& to, const Progress& progress) {
  constexpr double kInwards = 1e-3;  // of the way to the middle of the face
  constexpr double kFacing = 90, kOnSurface = 2;
  std::vector<Vec3> points;
  points.reserve(3 * to.triangles.size());
  for (std::uint32_t f = 0; f < to.triangles.size(); ++f) {
    const auto [a, b, c] = corners_of(to, f);
    const Vec3 middle = (1.0 / 3) * (a + b + c);
    for (const Vec3& corner : {a, b, c}) points.push_back(corner + kInwards * (middle - corner));
  }
  const auto corner = [&](std::size_t i) { return to.positions[to.triangles[i / 3][i % 3]]; };
  std::vector<ClosestPoint> closest = closest_points(sites, points, {.progress = progress});
  std::vector<std::size_t> off;  // corners that are not on the surface
  for (std::size_t i = 0; i < points.size(); ++i)
    if (closest[i].distance > kOnSurface * norm(points[i] - corner(i))) off.push_back(i);
  if (!off.empty()) {
    const std::vector<Vec3> normals = facing::outward_normals(to);
    std::vector<Vec3> points_off, directions;
    for (const std::size_t i : off) {
      points_off.push_back(points[i]);
      directions.push_back(normals[i / 3]);
    }
    const FacingPoints facing =
        closest_facing_points(sites, points_off, directions, kFacing, {.progress = progress});
    for (std::size_t i = 0; i < off.size(); ++i)
      if (facing.closest[i].face != kNone) closest[off[i]] = facing.closest[i];
  }
  std::vector<Origin> origins(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t face = closest[i].face;
    const auto [a, b, c] = corners_of(sites.mesh(), face);
    origins[i] = {face, barycentric(a, b, c, corner(i))};
  }
  return origins;
}

/// Rows of values, of which those of one vertex that are almost equal are one.
class Rows {
 public:
  Rows(const MeshAttribute& attribute, std::size_t vertices)
      : attribute_(attribute), is_normal_(attribute.name == "normal"), first_(vertices, kNone) {
    constexpr double kOfNormal = 0.05, kOfRange = 1e-3;
    const auto [least, most] = std::ranges::minmax_element(attribute.values);
    tolerance_ =
        is_normal_ ? kOfNormal : kOfRange * (attribute.values.empty() ? 0.0 : double{*most} - double{*least});
    result_ = {.name = attribute.name, .components = attribute.components, .values = {}, .rows = {}};
  }

  /// The row of a vertex at this place; kNone if the file has no value there.
  std::uint32_t at(std::uint32_t vertex, const Origin& origin) {
    const std::size_t n = attribute_.components;
    std::vector<double> sum(n);
    for (int k = 0; k < 3; ++k) {
      if (origin.weights[k] == 0) continue;
      const std::uint32_t row = (*attribute_.rows)[origin.face][k];
      if (row == kNone) return kNone;
      for (std::size_t i = 0; i < n; ++i) sum[i] += origin.weights[k] * attribute_.values[n * row + i];
    }
    if (is_normal_) normalise(sum);
    for (std::uint32_t row = first_[vertex]; row != kNone; row = next_[row])
      if (is_near(row, sum)) return row;
    const auto row = static_cast<std::uint32_t>(next_.size());
    for (const double x : sum) result_.values.push_back(static_cast<float>(x));
    next_.push_back(std::exchange(first_[vertex], row));
    return row;
  }
  MeshAttribute take(std::vector<Triangle> rows) {
    result_.rows = std::make_shared<const std::vector<Triangle>>(std::move(rows));
    return std::move(result_);
  }

 private:
  static void normalise(std::vector<double>& v) {
    double squared = 0;
    for (const double x : v) squared += x * x;
    if (squared > 0)
      for (double& x : v) x /= std::sqrt(squared);
  }
  [[nodiscard]] bool is_near(std::uint32_t row, const std::vector<double>& values) const {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!(std::abs(result_.values[row * values.size() + i] - values[i]) <= tolerance_)) return false;
    return true;
  }

  const MeshAttribute& attribute_;
  bool is_normal_;
  double tolerance_ = 0;
  MeshAttribute result_;
  std::vector<std::uint32_t> first_, next_;  ///< of each vertex, a list of its rows
};

}  // namespace

std::vector<std::uint32_t> face_regions(std::size_t faces, std::span<const std::uint32_t> face_materials,
                                        std::span<const FaceNames> names) {
  bool fits = face_materials.empty() || face_materials.size() == faces;
  for (const FaceNames& kind : names) fits &= kind.of_face.size() == faces;
  if (!fits) throw Error("regions need a material and names for each face");
  std::vector<std::uint32_t> regions(faces);
  std::map<std::vector<std::uint32_t>, std::uint32_t> first;
  std::vector<std::uint32_t> key;
  for (std::uint32_t f = 0; f < faces; ++f) {
    key.clear();
    if (!face_materials.empty()) key.push_back(face_materials[f]);
    for (const FaceNames& kind : names) key.push_back(kind.of_face[f]);
    regions[f] = first.try_emplace(key, f).first->second;
  }
  return regions;
}

std::vector<MeshAttribute> carried_attributes(const Sites& from, std::span<const MeshAttribute> attributes,
                                              const Mesh& to, const Progress& progress) try {
  std::vector<MeshAttribute> result;
  if (attributes.empty()) return result;
  for (const MeshAttribute& attribute : attributes)
    if (!attribute.rows || attribute.rows->size() != from.mesh().triangles.size())
      throw Error("an attribute needs rows for the corners of each face of the mesh");
  const std::vector<Origin> origins = origins_of(from, to, progress);
  for (const MeshAttribute& attribute : attributes) {
    Rows rows(attribute, to.positions.size());
    std::vector<Triangle> of_corners(to.triangles.size());
    for (std::size_t i = 0; i < origins.size(); ++i)
      of_corners[i / 3][i % 3] = rows.at(to.triangles[i / 3][i % 3], origins[i]);
    result.push_back(rows.take(std::move(of_corners)));
  }
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the attributes of a simplified mesh");
}

}  // namespace sdm
