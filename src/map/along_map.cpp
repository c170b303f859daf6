#include <sdm/along.h>
#include <sdm/error.h>
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <new>
#include <string>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/triangle.h"
#include "geometry/vec.h"
#include "map/map_writer.h"
#include "query/facing/outward_normals.h"
#include "query/rays/trace.h"
#include "sites/sites_data.h"
#include "surface/tiles.h"

namespace sdm {
namespace {

constexpr double kParallel = 1e-12;  // products of unit vectors up to here count as 0
constexpr std::size_t kTilesAtOnce = 16, kFacesAtOnce = 256;
constexpr float kNoDistance = std::numeric_limits<float>::quiet_NaN();

void check_options(const AlongOptions& options) {
  if (!(options.max_distance > 0)) throw Error("the maximum distance must be greater than 0");
  if (!options.direction) return;
  if (!finite(*options.direction) || !(norm(*options.direction) > 0) ||
      !std::isfinite(norm(*options.direction)))
    throw Error("the direction of distances must be finite and not 0");
}

enum class LineEnd : std::uint8_t { hit, too_far, none };

struct OnLine {
  LineEnd end = LineEnd::none;
  double distance = 0;  // signed
  Vec3 vector{};
  std::uint32_t face = kNone;
};

// Searches along the lines of the samples of one face after another.
class LineSearch {
 public:
  LineSearch(const sites::SitesData& sites, const AlongOptions& options) : sites_(sites), options_(options) {
    if (options.direction) {
      const Vec3& d = *options.direction;
      const double largest = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
      for (int k = 0; k < 3; ++k) direction_[k] = d[k] / largest;
      direction_ = normalized(direction_);
    }
  }

  // Finds hits() of these points of a face with the normal m; none if it is 0. Of points along a direction
  // without a normal, among all faces.
  void search(const std::optional<Vec3>& normal, std::span<const Vec3> points) {
    const Vec3 u = options_.direction ? direction_ : *normal, m = normal.value_or(u);
    found_.assign(points.size(), {});
    if (u == Vec3{} || !(std::abs(dot(m, u)) > kParallel)) return;
    const Vec3 towards = dot(m, u) > 0 ? u : -1.0 * u;
    rays_.clear();
    for (const Vec3& p : points) {
      rays_.push_back({.origin = p, .direction = u});
      rays_.push_back({.origin = p, .direction = -1.0 * u});
    }
    hits_.resize(rays_.size());
    const auto faces_alike = [&](std::size_t, std::uint32_t face) {
      return !normal || dot(normal_of(face), towards) > kParallel;
    };
    rays::first_hits(sites_, rays_, rays::filter(faces_alike), scratch_, hits_.data());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool ahead = hits_[2 * i].t <= hits_[2 * i + 1].t;
      const RayHit& hit = hits_[ahead ? 2 * i : 2 * i + 1];
      if (hit.face == kNone) continue;
      OnLine& found = found_[i];
      found.end = hit.t <= options_.max_distance ? LineEnd::hit : LineEnd::too_far;
      found.face = hit.face;
      found.vector = (ahead ? hit.t : -hit.t) * u;
      // (p − q)·n has the sign of −vector·n.
      found.distance = dot(found.vector, normal_of(hit.face)) > 0 ? -hit.t : hit.t;
    }
  }
  [[nodiscard]] std::span<const OnLine> hits() const { return found_; }
  // The unit vector of all lines, if it is given.
  [[nodiscard]] const Vec3& direction() const { return direction_; }

 private:
  [[nodiscard]] Vec3 normal_of(std::uint32_t face) const { return facing::outward_normal(sites_, face); }

  const sites::SitesData& sites_;
  const AlongOptions& options_;
  Vec3 direction_{};
  rays::Scratch scratch_;
  std::vector<Ray> rays_;
  std::vector<RayHit> hits_;
  std::vector<OnLine> found_;
};

void store_hit(const OnLine& hit, std::uint32_t texel, DistanceMap& map) {
  const bool found = hit.end == LineEnd::hit;
  map.distance[texel] = found ? static_cast<float>(hit.distance) : kNoDistance;
  for (int k = 0; k < 3; ++k) map.vector[texel][k] = found ? static_cast<float>(hit.vector[k]) : kNoDistance;
  map.site[texel] = found ? hit.face : kNone;
  map.site_type[texel] = found ? SiteType::face : SiteType::none;
  map.unmatched[texel] = hit.end == LineEnd::none ? 1 : 0;
}

ClosestPoint closest_of(const OnLine& hit, const Vec3& point) {
  if (hit.end != LineEnd::hit) return {};
  return {.point = point + hit.vector,
          .distance = std::abs(hit.distance),
          .site = hit.face,
          .type = SiteType::face,
          .face = hit.face};
}

}  // namespace

MeasuredDistance measured_distance(const AlongOptions& options, const std::string& sample) {
  if (!options.direction)
    return {DistanceKind::along, "distance along the normal of the " + sample + ", to both sides"};
  std::array<char, 160> text{};
  const Vec3& d = *options.direction;
  std::snprintf(text.data(), text.size(), "distance along the direction (%.6g %.6g %.6g), to both sides",
                d[0], d[1], d[2]);
  return {DistanceKind::along, text.data()};
}

FacingPoints closest_points_along(const Sites& sites, std::span<const Vec3> points,
                                  std::span<const Vec3> normals, const AlongOptions& options) try {
  check_options(options);
  if (normals.size() != points.size() && !(options.direction && normals.empty()))
    throw Error("distances along lines need one normal for each point, or a direction");
  if (!std::ranges::all_of(points, finite)) throw Error("points to measure from must be finite");
  const sites::SitesData& data = internals(sites);
  FacingPoints result;
  result.closest.resize(points.size());
  result.behind.resize(points.size()), result.unmatched.resize(points.size());
  constexpr std::size_t kPointsAtOnce = 256;
  const auto work = [&](std::size_t begin, std::size_t end) {
    LineSearch search(data, options);
    for (std::size_t i = begin; i < end; ++i) {
      std::optional<Vec3> normal;
      if (!normals.empty()) normal = finite(normals[i]) ? normalized(normals[i]) : Vec3{};
      search.search(normal, points.subspan(i, 1));
      const OnLine& hit = search.hits()[0];
      result.closest[i] = closest_of(hit, points[i]);
      result.behind[i] = hit.end == LineEnd::hit && hit.distance < 0 ? 1 : 0;
      result.unmatched[i] = hit.end == LineEnd::none ? 1 : 0;
    }
  };
  parallel_for(points.size(), kPointsAtOnce, options.progress, "points", work);
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the distances along lines of points");
}

DistanceMap along_map(const Surface& surface, const Sites& sites, const AlongOptions& options) try {
  check_options(options);
  const sites::SitesData& data = internals(sites);
  DistanceMap map;
  map::clear(map, surface);
  map.unmatched.assign(map.distance.size(), 0);
  map.sign = {SignMethod::side, "the side of the face that the line hits"};
  map.measured = measured_distance(options);
  const surface::Tiles tiles(surface);
  std::atomic<std::size_t> none{0}, too_far{0};
  const std::vector<Vec3> normals = facing::outward_normals(surface.mesh());
  parallel_for(tiles.count(), kTilesAtOnce, options.progress, "map", [&](std::size_t begin, std::size_t end) {
    LineSearch search(data, options);
    std::vector<Vec3> points;
    std::size_t none_here = 0, too_far_here = 0;
    for (std::size_t tile = begin; tile < end; ++tile) {
      const std::span<const std::uint32_t> texels = tiles.of(static_cast<std::uint32_t>(tile));
      points.clear();
      for (const std::uint32_t texel : texels) points.push_back(surface.texel_point(texel));
      search.search(normals[tiles.faces[tile]], points);
      for (std::size_t i = 0; i < texels.size(); ++i) {
        const OnLine& hit = search.hits()[i];
        store_hit(hit, texels[i], map);
        none_here += hit.end == LineEnd::none, too_far_here += hit.end == LineEnd::too_far;
      }
    }
    none += none_here, too_far += too_far_here;
  });
  map.without_match = none, map.beyond_max_distance = too_far;
  if (none == 0) map.unmatched.clear();
  return map;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the distances along lines");
}

namespace {

// Along a direction u, what faces alike depends on the sign of m·u only: each vertex is searched from once
// for each sign that its faces have.
std::vector<float> along_direction_at_vertices(const Mesh& mesh, const sites::SitesData& sites,
                                               const std::vector<Vec3>& normals,
                                               const AlongOptions& options) {
  LineSearch any(sites, options);
  const Vec3 u = any.direction();
  std::vector<std::array<signed char, 2>> sides(mesh.positions.size());  // in the order of the faces; 0: none
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const double product = dot(normals[f], u);
    if (!(std::abs(product) > kParallel)) continue;
    const auto side = static_cast<signed char>(product > 0 ? 1 : -1);
    for (const std::uint32_t v : mesh.triangles[f]) {
      auto& [first, second] = sides[v];
      if (first == 0)
        first = side;
      else if (first != side)
        second = side;
    }
  }
  std::vector<float> least(mesh.positions.size(), kNoDistance);
  parallel_for(least.size(), kFacesAtOnce, options.progress, "vertices",
               [&](std::size_t begin, std::size_t end) {
                 LineSearch search(sites, options);
                 for (std::size_t v = begin; v < end; ++v)
                   for (const signed char side : sides[v]) {
                     if (side == 0) continue;
                     search.search(static_cast<double>(side) * u, {&mesh.positions[v], 1});
                     const OnLine& hit = search.hits()[0];
                     if (hit.end != LineEnd::hit) continue;
                     const auto distance = static_cast<float>(hit.distance);
                     if (!(std::abs(distance) >= std::abs(least[v]))) least[v] = distance;
                   }
               });
  return least;
}

}  // namespace

std::vector<float> distances_along_at_vertices(const Mesh& mesh, const Sites& sites,
                                               const AlongOptions& options) try {
  check_options(options);
  const sites::SitesData& data = internals(sites);
  const std::vector<Vec3> normals = facing::outward_normals(mesh);
  if (options.direction) return along_direction_at_vertices(mesh, data, normals, options);
  std::vector<std::array<float, 3>> at_corners(mesh.triangles.size(),
                                               {kNoDistance, kNoDistance, kNoDistance});
  const auto work = [&](std::size_t begin, std::size_t end) {
    LineSearch search(data, options);
    for (std::size_t f = begin; f < end; ++f) {
      if (is_removed(mesh.triangles[f])) continue;
      search.search(normals[f], corners_of(mesh, f));
      for (std::size_t k = 0; k < 3; ++k)
        if (const OnLine& hit = search.hits()[k]; hit.end == LineEnd::hit)
          at_corners[f][k] = static_cast<float>(hit.distance);
    }
  };
  parallel_for(mesh.triangles.size(), kFacesAtOnce, options.progress, "vertices", work);
  std::vector<float> least(mesh.positions.size(), kNoDistance);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      if (std::isnan(at_corners[f][k])) continue;
      float& value = least[mesh.triangles[f][k]];
      if (std::isnan(value) || std::abs(at_corners[f][k]) < std::abs(value)) value = at_corners[f][k];
    }
  return least;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the distances along lines at vertices");
}

}  // namespace sdm
