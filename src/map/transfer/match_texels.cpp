#include <sdm/closest_points.h>
#include <sdm/error.h>
#include <sdm/match.h>

#include <algorithm>
#include <cstddef>
#include <new>
#include <optional>
#include <span>
#include <vector>

#include "closest/facing/facing_normals.h"
#include "closest/facing/facing_search.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/barycentric.h"
#include "geometry/triangle.h"
#include "map/transfer/closest_of_texels.h"
#include "map/transfer/corner_normals.h"
#include "rays/trace.h"
#include "surface/tiles.h"

namespace sdm::map {
namespace {

/// Matches of this surface, all of kind `none`.
TexelMatches no_matches(const Surface& surface) {
  const std::size_t texels = surface.texel_faces().size();
  TexelMatches matches;
  matches.resolution = surface.resolution();
  matches.kind.resize(texels, MatchKind::none);
  matches.face.resize(texels, kNone);
  matches.barycentric.resize(texels);
  return matches;
}

/// Stores the point of O2 that belongs to a texel.
void store_match(TexelMatches& matches, std::size_t texel, MatchKind kind, const SurfacePoint& point) {
  matches.kind[texel] = kind;
  matches.face[texel] = point.face;
  if (point.face != kNone)
    matches.barycentric[texel] = {static_cast<float>(point.barycentric[1]),
                                  static_cast<float>(point.barycentric[2])};
}

constexpr std::size_t kTilesOfTask = 16, kPointsOfTask = 256;

/// Data of the rays of all texels.
struct RayMatching {
  const Surface& surface;
  const sites::SitesData& sites;
  const facing::FacingSearch& allowed;
  std::span<const Vec3> face_normals;  ///< outward, of O1
  const CornerNormals& normals;
  double max_length;  ///< of rays
};

/// Searches from the texels of one face after another.
class NormalRays {
 public:
  explicit NormalRays(const RayMatching& matching) : matching_(matching) {}

  /// Finds hits() of these texels of a face.
  void search(std::uint32_t face, std::span<const std::uint32_t> texels) {
    const Vec3& facing = matching_.face_normals[face];
    rays_.clear();
    found_.assign(texels.size(), {});
    if (facing == Vec3{}) return;
    const BarycentricFrame frame(corners_of(matching_.surface.mesh(), face));
    for (const std::uint32_t texel : texels) {
      const Vec3 p = matching_.surface.texel_point(texel);
      const Vec3 n = normalized(matching_.normals.at(face, frame.weights(p)));
      rays_.push_back({.origin = p, .direction = dot(n, facing) < 0 ? -n : n, .t_max = matching_.max_length});
    }
    const auto allows = [&](std::size_t, std::uint32_t other) {
      return matching_.allowed.allows(facing, other);
    };
    rays::first_hits(matching_.sites, rays_, rays::filter(allows), scratch_, found_.data());
    // Inwards, only as far as the hit outwards.
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      rays_[i].direction = -rays_[i].direction;
      rays_[i].t_max = std::min(matching_.max_length, found_[i].t);
    }
    inwards_.resize(rays_.size());
    rays::first_hits(matching_.sites, rays_, rays::filter(allows), scratch_, inwards_.data());
    for (std::size_t i = 0; i < rays_.size(); ++i)
      if (inwards_[i].t < found_[i].t) found_[i] = inwards_[i];
  }
  /// A hit for each ray; its face is kNone where there is none.
  [[nodiscard]] std::span<const RayHit> hits() const { return found_; }

 private:
  const RayMatching& matching_;
  rays::Scratch scratch_;
  std::vector<Ray> rays_;
  std::vector<RayHit> found_, inwards_;
};

void match_along_rays(const RayMatching& matching, const Progress& progress, TexelMatches& matches) {
  const surface::Tiles tiles(matching.surface, matching.surface.texel_faces(), surface::Tiles::kSide);
  parallel_for(tiles.count(), kTilesOfTask, progress, "rays", [&](std::size_t begin, std::size_t end) {
    NormalRays search(matching);
    for (std::size_t tile = begin; tile < end; ++tile) {
      const std::span<const std::uint32_t> texels = tiles.of(static_cast<std::uint32_t>(tile));
      search.search(tiles.faces[tile], texels);
      for (std::size_t i = 0; i < texels.size(); ++i)
        if (search.hits()[i].face != kNone) store_match(matches, texels[i], MatchKind::ray, search.hits()[i]);
    }
  });
}

/// Matches the owned texels that have no point yet with the closest point of allowed faces.
void match_the_rest(const RayMatching& matching, const Sites& sites, const MatchOptions& options,
                    TexelMatches& matches) {
  std::vector<std::uint32_t> texels;
  std::vector<Vec3> points;
  for (const std::uint32_t texel : matching.surface.sample_texels()) {
    if (texel >= matches.kind.size() || matches.kind[texel] != MatchKind::none) continue;
    texels.push_back(texel);
    points.push_back(matching.surface.texel_point(texel));
  }
  if (texels.empty()) return;
  const std::vector<ClosestPoint> closest = closest_points(
      sites, points,
      {.engine = options.engine, .max_distance = options.max_distance, .progress = options.progress});
  const auto faces = matching.surface.texel_faces();
  parallel_for(texels.size(), kPointsOfTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& normal = matching.face_normals[faces[texels[i]]];
      const facing::Match match = matching.allowed.match(points[i], normal, options.max_distance, closest[i]);
      if (match.unmatched || match.closest.type == SiteType::none) {
        matches.kind[texels[i]] = match.unmatched ? MatchKind::facing_away : MatchKind::too_far;
        continue;
      }
      const std::uint32_t face =
          face_that_faces(matching.sites, match.closest.type, match.closest.site, normal);
      const BarycentricFrame frame(corners_of(matching.sites.mesh, face));
      store_match(matches, texels[i], MatchKind::facing, {face, frame.weights(match.closest.point)});
    }
  });
}

/// match_texels() of MatchMethod::ray, with options in range.
TexelMatches ray_matches(const Surface& surface, const Sites& sites, const MatchOptions& options) {
  std::optional<MeshAttribute> smooth;
  if (options.normals == nullptr) smooth = smooth_normals(surface.mesh());
  const CornerNormals normals(surface.mesh(), smooth ? *smooth : *options.normals, "the surface");
  const facing::FacingSearch allowed(internals(sites), options.facing);
  const std::vector<Vec3> face_normals = facing::facing_normals(surface, options.facing).normals;
  const RayMatching matching{surface,      internals(sites), allowed,
                             face_normals, normals,          std::min(options.cage, options.max_distance)};
  TexelMatches matches = no_matches(surface);
  match_along_rays(matching, options.progress, matches);
  match_the_rest(matching, sites, options, matches);
  return matches;
}

}  // namespace
}  // namespace sdm::map

namespace sdm {
namespace {

MatchKind kind_of(const MeasuredDistance& measured) {
  switch (measured.kind) {
    case DistanceKind::closest:
    case DistanceKind::self:
      return MatchKind::closest;
    case DistanceKind::facing:
      return MatchKind::facing;
    case DistanceKind::along:
      return MatchKind::ray;
    case DistanceKind::thickness:
      break;
  }
  throw Error("a map of thickness has no matches: its vectors end on the surface itself");
}

}  // namespace

void require_matches(const Surface& surface, const Sites& sites, const TexelMatches& matches) {
  const std::size_t texels = surface.texel_faces().size(), faces = sites.mesh().triangles.size();
  if (matches.resolution != surface.resolution() || matches.kind.size() != texels ||
      matches.face.size() != texels || matches.barycentric.size() != texels)
    throw Error("the matches belong to another surface: their number of texels differs");
  if (std::ranges::any_of(matches.face, [&](std::uint32_t face) { return face != kNone && face >= faces; }))
    throw Error("the matches name a face that the other mesh does not have");
}

TexelMatches matches_of(const Surface& surface, const Sites& sites, const DistanceMap& map,
                        const Progress& progress) try {
  if (map.distance.size() != surface.map_faces().size() || map.resolution != surface.resolution())
    throw Error("the map belongs to another surface: its number of texels differs");
  const MatchKind found = kind_of(map.measured);
  const std::vector<Vec3> normals =
      found == MatchKind::facing ? facing::facing_normals(surface, map.measured.facing.value_or(90)).normals
                                 : std::vector<Vec3>();
  const auto faces = surface.texel_faces();
  TexelMatches matches = map::no_matches(surface);
  constexpr std::size_t kRowsOfTask = 8;
  parallel_for(map.rows(), kRowsOfTask, progress, "matches", [&](std::size_t begin, std::size_t end) {
    map::ClosestOfTexels points(surface, sites, map, normals);
    for (std::size_t i = begin * map.resolution; i < end * map.resolution; ++i) {
      if (faces[i] == kNone) continue;
      const SurfacePoint point = points.at(static_cast<std::uint32_t>(i));
      const bool away = !map.unmatched.empty() && map.unmatched[i] != 0;
      map::store_match(matches, i,
                       point.face != kNone ? found
                       : away              ? MatchKind::facing_away
                                           : MatchKind::too_far,
                       point);
    }
  });
  return matches;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the matches of texels");
}

TexelMatches match_texels(const Surface& surface, const Sites& sites, const MatchOptions& options) try {
  check_options(options);
  if (options.method == MatchMethod::ray) return map::ray_matches(surface, sites, options);
  MapOptions of_map{.engine = options.engine,
                    .sign = SignMethod::none,
                    .max_distance = options.max_distance,
                    .progress = options.progress};
  if (options.method == MatchMethod::facing) of_map.facing = options.facing;
  return matches_of(surface, sites, compute_map(surface, sites, of_map));
} catch (const std::bad_alloc&) {
  throw out_of_memory("the matches of texels");
}

}  // namespace sdm
