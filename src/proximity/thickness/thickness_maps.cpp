#include <sdm/error.h>
#include <sdm/thickness.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>

#include "core/atomic_extremes.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "map/map_writer.h"
#include "proximity/thickness/thickness_search.h"
#include "surface/tiles.h"

namespace sdm {
namespace {

constexpr std::size_t kTilesAtOnce = 16, kFacesAtOnce = 256;
constexpr float kNoThickness = std::numeric_limits<float>::quiet_NaN();

// Returns whether there is a value.
bool store_end(const thickness::WallEnd& end, const Vec3& p, std::uint32_t texel, DistanceMap& map) {
  const bool found = end.face != kNone;
  map.distance[texel] = found ? static_cast<float>(end.thickness) : kNoThickness;
  for (int k = 0; k < 3; ++k)
    map.vector[texel][k] = found ? static_cast<float>(end.point[k] - p[k]) : kNoThickness;
  map.site[texel] = end.face;
  map.site_type[texel] = found ? SiteType::face : SiteType::none;
  return found;
}

void clear_thickness(DistanceMap& map, const Surface& surface, const char* text) {
  map::clear(map, surface);
  map.sign.reason = "a thickness has no sign";
  map.measured = {DistanceKind::thickness, text};
}

}  // namespace

ThicknessMaps thickness_maps(const Surface& surface, const Sites& sites,
                             const ThicknessOptions& options) try {
  if (surface.mesh().triangles.size() != sites.mesh().triangles.size())
    throw Error("surface and sites belong to different meshes: their numbers of faces differ");
  const thickness::Walls walls(internals(sites), options.angle);
  ThicknessMaps maps;
  clear_thickness(maps.ball, surface, "wall thickness, the diameter of the largest ball in the part");
  clear_thickness(maps.ray, surface, "wall thickness, the length of the ray along the normal into the part");
  const surface::Tiles tiles(surface);
  std::atomic<std::size_t> no_ball{0}, no_ray{0};
  parallel_for(tiles.count(), kTilesAtOnce, options.progress, "map", [&](std::size_t begin, std::size_t end) {
    thickness::WallSearch search(walls);
    std::vector<Vec3> points;
    std::size_t without_ball = 0, without_ray = 0;
    for (std::size_t tile = begin; tile < end; ++tile) {
      const std::span<const std::uint32_t> texels = tiles.of(static_cast<std::uint32_t>(tile));
      const std::uint32_t face = tiles.faces[tile];
      const bool measured = walls.measures(face);
      points.clear();
      for (const std::uint32_t texel : texels) points.push_back(surface.texel_point(texel));
      if (measured) search.start(face, points);
      for (std::size_t i = 0; i < texels.size(); ++i) {
        const thickness::WallEnd ray = measured ? search.rays()[i] : thickness::WallEnd{};
        const thickness::WallEnd ball = measured ? search.ball(points[i], ray) : thickness::WallEnd{};
        without_ray += !store_end(ray, points[i], texels[i], maps.ray);
        without_ball += !store_end(ball, points[i], texels[i], maps.ball);
      }
    }
    no_ball += without_ball, no_ray += without_ray;
  });
  maps.ball.beyond_max_distance = no_ball, maps.ray.beyond_max_distance = no_ray;
  return maps;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the thickness of a surface");
}

std::vector<float> thickness_at_vertices(const Sites& sites, ThicknessMethod method,
                                         const ThicknessOptions& options) try {
  const thickness::Walls walls(internals(sites), options.angle);
  const Mesh& mesh = sites.mesh();
  std::vector<float> least(mesh.positions.size(), std::numeric_limits<float>::infinity());
  const auto work = [&](std::size_t begin, std::size_t end) {
    thickness::WallSearch search(walls);
    for (std::size_t f = begin; f < end; ++f) {
      const auto face = static_cast<std::uint32_t>(f);
      if (!walls.measures(face)) continue;
      const Corners corners = corners_of(mesh, face);
      search.start(face, corners);
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const thickness::WallEnd& ray = search.rays()[k];
        const auto end_here = method == ThicknessMethod::ray ? ray : search.ball(corners[k], ray);
        if (end_here.face != kNone)
          atomic_min(least[mesh.triangles[face][k]], static_cast<float>(end_here.thickness));
      }
    }
  };
  parallel_for(mesh.triangles.size(), kFacesAtOnce, options.progress, "vertices", work);
  for (float& value : least)
    if (std::isinf(value)) value = kNoThickness;
  return least;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the thickness at vertices");
}

namespace {

/// The first texels in an order of their values, apart from each other.
template <class Before>
std::vector<std::uint32_t> first_texels(const Surface& surface, const DistanceMap& map, std::size_t count,
                                        const Before& before) {
  if (map.distance.size() != surface.texel_faces().size()) throw Error("the map belongs to another surface");
  constexpr double kApart = 0.06;  // of the diagonal, as the places of pages
  const double apart = kApart * diagonal(bounds(surface.mesh()));
  std::vector<std::uint32_t> texels;
  for (const std::uint32_t texel : surface.sample_texels())
    if (std::isfinite(map.distance[texel])) texels.push_back(texel);
  std::ranges::stable_sort(texels, before, [&](std::uint32_t texel) { return map.distance[texel]; });
  std::vector<std::uint32_t> places;
  for (const std::uint32_t texel : texels) {
    if (places.size() >= count) break;
    const Vec3 p = surface.texel_point(texel);
    const auto near = [&](std::uint32_t place) { return norm(surface.texel_point(place) - p) < apart; };
    if (std::ranges::none_of(places, near)) places.push_back(texel);
  }
  return places;
}

}  // namespace

std::vector<std::uint32_t> thinnest_texels(const Surface& surface, const DistanceMap& map,
                                           std::size_t count) {
  return first_texels(surface, map, count, std::ranges::less());
}

std::vector<std::uint32_t> thickest_texels(const Surface& surface, const DistanceMap& map,
                                           std::size_t count) {
  return first_texels(surface, map, count, std::ranges::greater());
}

double thickness_accuracy(const Mesh& mesh) {
  return 1e-7 * diagonal(bounds(mesh));  // a float is rounded by 6e-8
}

}  // namespace sdm
