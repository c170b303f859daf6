#include "research/figures/site_pairs.h"

#include <sdm/closest_points.h>

#include <algorithm>
#include <array>
#include <set>
#include <span>

#include "core/parallel.h"
#include "gl/polygons/convex_polygon.h"
#include "gl/polygons/site_region.h"
#include "sites/sites_data.h"

namespace sdm::figures {
namespace {

/// Walls are moved outwards by this in the unit frame, as the engines do.
constexpr double kSlack = 0x1p-20;

std::vector<gl::SiteRegion> regions_of(const sites::SitesData& data) {
  std::vector<gl::SiteRegion> result;
  for (std::size_t leaf = 0; leaf + 1 < data.regions.leaves.size(); ++leaf)
    gl::for_each_site(data.regions, leaf, [&](const auto& region, std::size_t i) {
      if (gl::has_interior(region)) result.push_back(gl::region_of(data, region, i));
    });
  return result;
}

/// Whether the walls leave some of the triangle.
bool intersects(const gl::SiteRegion& region, const std::array<Vec3, 3>& corners) {
  const std::span walls(region.walls.data(), static_cast<std::size_t>(region.wall_count));
  const auto height = [](const gl::HalfSpace& w, const Vec3& p) {
    return dot(w.normal, p) - w.offset + kSlack;
  };
  for (const gl::HalfSpace& w : walls)
    if (std::ranges::all_of(corners, [&](const Vec3& p) { return height(w, p) < 0; })) return false;
  // In coordinates (u, v) of the corner a and two edges, in which the triangle is u, v ≥ 0, u + v ≤ 1.
  const auto& [a, b, c] = corners;
  gl::ConvexPolygon polygon = gl::ConvexPolygon::rectangle({0, 0}, {1, 1});
  polygon.cut({1, {-1, -1}});
  for (const gl::HalfSpace& w : walls)
    polygon.cut({height(w, a), {dot(w.normal, b - a), dot(w.normal, c - a)}});
  return !polygon.empty();
}

std::vector<std::uint32_t> faces_with_texels(const Surface& surface) {
  std::vector<std::uint32_t> faces;
  for (const std::uint32_t face : surface.texel_faces())
    if (face != kNone) faces.push_back(face);
  std::ranges::sort(faces);
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

}  // namespace

DrawOrder intersecting_pairs(const Surface& surface, const Sites& sites) {
  const sites::SitesData& data = internals(sites);
  const std::vector<gl::SiteRegion> regions = regions_of(data);
  const std::vector<std::uint32_t> faces = faces_with_texels(surface);
  std::vector<std::array<Vec3, 3>> corners;
  for (const std::uint32_t f : faces) {
    const auto& p = surface.mesh().positions;
    const auto& [i, j, k] = surface.mesh().triangles[f];
    corners.push_back({data.frame.to_unit(p[i]), data.frame.to_unit(p[j]), data.frame.to_unit(p[k])});
  }
  std::vector<DrawOrder> of_site(regions.size());
  parallel_for(regions.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t f = 0; f < faces.size(); ++f)
        if (intersects(regions[s], corners[f])) of_site[s].push_back(faces[f]);
  });
  DrawOrder all;
  for (const DrawOrder& order : of_site) all.insert(all.end(), order.begin(), order.end());
  return all;
}

DrawOrder winning_pairs(const Surface& surface, const Sites& sites) {
  const auto& items = internals(sites).tree.items;
  std::vector<std::uint32_t> place(sites.mesh().triangles.size());
  for (std::uint32_t i = 0; i < items.size(); ++i) place[items[i]] = i;
  const std::vector<ClosestPoint> closest = closest_points(sites, surface.sample_points());
  std::vector<std::array<std::uint32_t, 4>> pairs;  // in the order of O2's tree
  for (std::size_t i = 0; i < closest.size(); ++i)
    pairs.push_back({place[closest[i].face], static_cast<std::uint32_t>(closest[i].type), closest[i].site,
                     surface.map_faces()[surface.sample_texels()[i]]});
  std::ranges::sort(pairs);
  // A site may be found through several of its faces: only its first place counts.
  std::set<std::array<std::uint32_t, 3>> drawn;
  DrawOrder order;
  for (const auto& [at, type, site, face] : pairs)
    if (drawn.insert({type, site, face}).second) order.push_back(face);
  return order;
}

}  // namespace sdm::figures
