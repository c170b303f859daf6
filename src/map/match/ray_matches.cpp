#include "map/match/ray_matches.h"

#include <sdm/closest_points.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "closest/facing/facing_normals.h"
#include "closest/facing/facing_search.h"
#include "core/parallel.h"
#include "geometry/barycentric.h"
#include "geometry/triangle.h"
#include "geometry/vec.h"
#include "map/match/corner_normals.h"
#include "map/match/texel_match.h"
#include "map/transfer/closest_of_texels.h"
#include "rays/trace.h"
#include "surface/tiles.h"

namespace sdm::map {
namespace {

constexpr std::size_t kTilesOfTask = 16, kPointsOfTask = 256;

/// What the rays of all texels share.
struct RayMatching {
  const Surface& surface;
  const sites::SitesData& sites;
  const facing::FacingSearch& allowed;
  std::span<const Vec3> face_normals;  ///< outward, of O1
  const CornerNormals& normals;
  double reach;
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
      rays_.push_back({.origin = p, .direction = dot(n, facing) < 0 ? -n : n, .t_max = matching_.reach});
    }
    const auto allows = [&](std::size_t, std::uint32_t other) {
      return matching_.allowed.allows(facing, other);
    };
    rays::first_hits(matching_.sites, rays_, rays::filter(allows), scratch_, found_.data());
    // Inwards, only as far as the hit outwards.
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      rays_[i].direction = -rays_[i].direction;
      rays_[i].t_max = std::min(matching_.reach, found_[i].t);
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

}  // namespace

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

}  // namespace sdm::map
