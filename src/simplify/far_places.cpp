#include "simplify/far_places.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "certify/hausdorff/nearest_face.h"
#include "core/parallel.h"
#include "geometry/triangle.h"
#include "simplify/high_parts.h"
#include "sites/sites_data.h"

namespace sdm::simplify {
namespace {

/// Corners of the face of the result that is nearest to a part.
struct Place {
  Triangle vertices{kNone, kNone, kNone};
  bool is_far = false;
};

// `parts`: of a surface; `to`: the other one.
void add_places(const Mesh& parts, const sites::SitesData& to, const sites::SitesData& result, double limit,
                std::vector<Place>& places) {
  const std::size_t first = places.size();
  places.resize(first + parts.triangles.size());
  parallel_for(parts.triangles.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Corners c = corners_of(parts, i);
      const std::array points{(1.0 / 3) * (c[0] + c[1] + c[2]), c[0], c[1], c[2]};
      Place& place = places[first + i];
      place.vertices = result.mesh.triangles[hausdorff::nearest_face(result, points[0], kNone).face];
      place.is_far = std::ranges::any_of(
          points, [&](const Vec3& p) { return hausdorff::nearest_face(to, p, kNone).lower > limit; });
    }
  });
}

}  // namespace

std::vector<std::uint32_t> far_places(const Sites& input, const Mesh& result, double limit,
                                      const Progress& progress) {
  const Sites sites(result);
  std::vector<Place> places;
  add_places(parts_above(input.mesh(), internals(sites), limit, progress), internals(sites), internals(sites),
             limit, places);
  add_places(parts_above(result, internals(input), limit, progress), internals(input), internals(sites),
             limit, places);
  const bool any_far = std::ranges::any_of(places, &Place::is_far);
  std::vector<std::uint32_t> vertices;
  for (const Place& place : places)
    if (place.is_far || !any_far)
      vertices.insert(vertices.end(), place.vertices.begin(), place.vertices.end());
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  return vertices;
}

}  // namespace sdm::simplify
