#include <sdm/bake.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <vector>

#include "baking/geometry/bent_normals.h"
#include "baking/geometry/texel_walk.h"
#include "closest/facing/facing_normals.h"
#include "core/memory.h"
#include "map/measures/thickness_measure.h"
#include "map/transfer/corner_normals.h"
#include "map/transfer/fill_texels.h"
#include "sites/sites_data.h"

namespace sdm {
namespace {

void store_vector(const Vec3& vector, std::uint32_t texel, std::vector<float>& values) {
  for (int k = 0; k < 3; ++k) values[3 * std::size_t{texel} + k] = static_cast<float>(vector[k]);
}

struct NoState {};

/// Whether the normals of a face that Sites has turned outwards point inwards.
bool points_inwards(const sites::SitesData& data, const map::CornerNormals& normals, std::uint32_t face) {
  if (data.inverted[face] == 0) return false;
  const Vec3 outward = facing::outward_normal(data, face);
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += dot(normals.of_corner(face, k), outward);
  return sum < 0;
}

}  // namespace

std::vector<float> matched_thickness(const Surface& surface, const Sites& sites, const TexelMatches& matches,
                                     ThicknessMethod method, const ThicknessOptions& options) try {
  require_matches(surface, sites, matches);
  const sites::SitesData& data = internals(sites);
  const thickness::Walls walls(data, method, options.angle);
  std::vector<float> values = baking::no_values(matches, 1, "the thickness of matches");
  baking::for_each_rows(surface, options.progress, "thickness", [&](std::uint32_t begin, std::uint32_t end) {
    std::vector<std::uint32_t> texels;
    std::vector<thickness::WallStart> starts;
    for (std::uint32_t texel = begin; texel < end; ++texel) {
      const SurfacePoint point = matches.point(texel);
      if (point.face == kNone || !walls.measures(point.face)) continue;
      texels.push_back(texel);
      starts.push_back({point.face, baking::position_of(data.mesh, point)});
    }
    std::vector<thickness::WallEnd> ends(starts.size());
    thickness::WallSearch(walls).measure(method, starts, ends);
    for (std::size_t i = 0; i < texels.size(); ++i)
      if (ends[i].face != kNone) values[texels[i]] = static_cast<float>(ends[i].thickness);
  });
  return values;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the thickness of matches");
}

std::vector<float> matched_normals(const Surface& surface, const Sites& sites, const TexelMatches& matches,
                                   const MeshAttribute& normals, const Progress& progress,
                                   const MeshLook* look) try {
  require_matches(surface, sites, matches);
  const sites::SitesData& data = internals(sites);
  const map::CornerNormals corners(data.mesh, normals, "the other mesh");
  if (look != nullptr) baking::require_fitting(data.mesh, *look);
  const MeshLook plain;
  const baking::NormalTextures textures(data.mesh, look != nullptr ? *look : plain, corners);
  std::vector<float> values = baking::no_values(matches, 3, "the normals of matches");
  baking::for_each_texel(
      surface, progress, "normals", [&] { return baking::NormalTextures::Reader(textures); },
      [&](std::uint32_t texel, baking::NormalTextures::Reader& reader) {
        const SurfacePoint point = matches.point(texel);
        if (point.face == kNone) return;
        const Vec3 normal = reader.at(point, surface.texel_edges(surface.texel_faces()[texel]),
                                      corners.at(point.face, point.barycentric));
        store_vector(points_inwards(data, corners, point.face) ? -normal : normal, texel, values);
      });
  return values;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the normals of matches");
}

std::vector<float> matched_positions(const Surface& surface, const Sites& sites, const TexelMatches& matches,
                                     const Progress& progress) try {
  require_matches(surface, sites, matches);
  const Mesh& mesh = sites.mesh();
  std::vector<float> values = baking::no_values(matches, 3, "the positions of matches");
  baking::for_each_texel(
      surface, progress, "positions", [] { return NoState(); },
      [&](std::uint32_t texel, NoState&) {
        const SurfacePoint point = matches.point(texel);
        if (point.face != kNone) store_vector(baking::position_of(mesh, point), texel, values);
      });
  return values;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the positions of matches");
}

std::vector<float> matched_displacements(const Surface& surface, const Sites& sites,
                                         const TexelMatches& matches, const MeshAttribute& normals,
                                         const Progress& progress) try {
  require_matches(surface, sites, matches);
  const map::CornerNormals corners(surface.mesh(), normals, "the surface");
  std::vector<float> values = baking::no_values(matches, 1, "the displacements of matches");
  baking::for_each_texel(
      surface, progress, "displacements", [&] { return baking::TexelPlaces(internals(surface)); },
      [&](std::uint32_t texel, baking::TexelPlaces& places) {
        const SurfacePoint point = matches.point(texel);
        if (point.face == kNone || surface.texel_faces()[texel] == kNone) return;
        const auto place = places.at(texel);
        const Vec3 way = baking::position_of(sites.mesh(), point) - place.point;
        values[texel] = static_cast<float>(dot(way, normalized(corners.at(place.face, place.weights))));
      });
  return values;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the displacements of matches");
}

void fill_texels(const Surface& surface, std::size_t components, std::span<float> values,
                 bool unmatched) try {
  const auto faces = surface.texel_faces();
  if (components == 0 || values.size() != components * faces.size())
    throw Error("values to fill must be the same number for each texel of the surface");
  std::vector<map::TexelState> states(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto of_texel = values.subspan(i * components, components);
    const bool finite = std::ranges::all_of(of_texel, [](float x) { return std::isfinite(x); });
    states[i] = faces[i] != kNone && finite      ? map::TexelState::valued
                : faces[i] == kNone || unmatched ? map::TexelState::free
                                                 : map::TexelState::missing;
  }
  map::fill_free_texels(surface.resolution(), states, map::gutter_of_values(surface.gutter()), components,
                        values);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the values of texels");
}

void fill_texels(std::uint32_t resolution, std::size_t components, std::span<float> values,
                 std::uint32_t gutter) try {
  if (components == 0 || resolution == 0 || values.size() % (components * resolution) != 0)
    throw Error("values to fill must be whole rows of texels");
  std::vector<map::TexelState> states(values.size() / components);
  for (std::size_t i = 0; i < states.size(); ++i)
    states[i] = std::ranges::all_of(values.subspan(i * components, components),
                                    [](float x) { return std::isfinite(x); })
                    ? map::TexelState::valued
                    : map::TexelState::free;
  map::fill_free_texels(resolution, states, map::gutter_of_values(gutter), components, values);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the values of texels");
}

}  // namespace sdm
