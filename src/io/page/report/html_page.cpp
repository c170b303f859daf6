#include "io/page/report/html_page.h"

#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/measure.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "io/page/report/area_by_value.h"
#include "io/page/report/page_file.h"
#include "io/page/report/page_ghost.h"
#include "io/page/report/page_model.h"

namespace sdm::io {
namespace {

using Json = nlohmann::ordered_json;

// A page of so many triangles has a quarter of the texels, whose values would take more than the part.
constexpr std::size_t kManyTriangles = 200'000;

Json json_of_texels(const Surface& surface, const DistanceMap& map,
                    const std::vector<std::uint32_t>& texels) {
  Json json = Json::array();
  for (const std::uint32_t texel : texels)
    json.push_back(
        {{"distance", map.distance[texel]}, {"point", surface.texel_point(texel)}, {"at", "texel"}});
  return json;
}

/// Throws if the coverage or the names are of another mesh.
void check_meshes_of(const Surface& surface, const HtmlOptions& options) {
  for (const FaceNames& kind : options.names)
    if (kind.of_face.size() != surface.mesh().triangles.size())
      throw Error("the names belong to another mesh");
  if (options.coverage &&
      (!options.other || options.coverage->of_face.size() != options.other->triangles.size()))
    throw Error("the coverage belongs to another mesh");
}

}  // namespace

HtmlPage html_page(const Surface& surface, const DistanceMap& map, std::span<const float> vertex_distances,
                   const HtmlOptions& options) {
  if (map.distance.size() != surface.map_faces().size() ||
      vertex_distances.size() != surface.mesh().positions.size())
    throw Error("the map or the distances belong to another surface");
  check_meshes_of(surface, options);

  const std::uint32_t largest = surface.mesh().triangles.size() < kManyTriangles
                                    ? options.largest
                                    : std::max<std::uint32_t>(1, options.largest / 2);
  Json page, map_json, model, ghost;
  PackedArrays arrays, model_arrays, ghost_arrays;
  Json listed;
  AreaByValue area;
  run_concurrently(
      {[&] { map_json = add_map(arrays, surface, map, largest); },
       [&] {
         model =
             add_model(model_arrays, surface, vertex_distances, options.names, largest, options.triangles);
       },
       [&] {
         if (options.other)
           ghost = add_ghost(ghost_arrays, *options.other, options.coverage, options.triangles_of_other);
       },
       [&] {
         if (options.places == ListedPlaces::least)
           listed = json_of_texels(surface, map, thinnest_texels(surface, map));
         else if (options.places == ListedPlaces::largest)
           listed = json_of_texels(surface, map, thickest_texels(surface, map));
       },
       [&] { area = area_by_value(surface, map); }});
  arrays.add(std::move(model_arrays));
  arrays.add(std::move(ghost_arrays));
  page = common_json(options.up);
  page["area"] = add_area(arrays, area);
  page["map"] = map_json;
  page["model"] = model;
  if (options.other) page["ghost"] = ghost;
  if (options.places == ListedPlaces::least) page["thinnest"] = listed;
  if (options.places == ListedPlaces::largest) page["thickest"] = listed;
  return {std::move(page), std::move(arrays)};
}

}  // namespace sdm::io
