#include "io/mesh/mesh_file.h"

#include <fmt/format.h>
#include <sdm/mesh_attributes.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/excerpt.h"
#include "io/mesh/mesh_attributes.h"

namespace sdm::io {
namespace {

// Adds the names of a kind, unless the file has none.
void add_names(const char* kind, const PolygonNames& polygons,
               const std::vector<std::uint32_t>& triangle_ends, std::vector<FaceNames>& all) {
  if (polygons.names().empty()) return;
  FaceNames result{.kind = kind, .names = polygons.names(), .of_face = {}};
  const std::size_t triangles = triangle_ends.empty() ? 0 : triangle_ends.back();
  const auto first_triangle = [&](std::size_t polygon) {
    return polygon == 0 ? 0 : triangle_ends[std::min(polygon, triangle_ends.size()) - 1];
  };
  result.of_face.assign(triangles, kNone);
  const auto& runs = polygons.runs();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::size_t end = i + 1 < runs.size() ? first_triangle(runs[i + 1].first_polygon) : triangles;
    for (std::size_t f = first_triangle(runs[i].first_polygon); f < end; ++f)
      result.of_face[f] = runs[i].name;
  }
  all.push_back(std::move(result));
}

// The sets of coordinates that the textures of a material are placed by.
std::set<std::uint32_t> uv_sets_of(const Material& m) {
  std::set<std::uint32_t> sets;
  for (const TextureUse* use : {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture,
                                &m.occlusion_texture, &m.emissive_texture})
    if (use->texture != kNone) sets.insert(use->uv_set);
  return sets;
}

// A texture has no place on faces without coordinates: they have the colour of the material alone.
void note_missing_coordinates(MeshFile& file) {
  struct Need {
    std::uint32_t set = 0;
    const MeshAttribute* uvs = nullptr;  // null: none at all
    std::size_t faces = 0;               // without coordinates
  };
  std::vector<std::vector<Need>> needs(file.materials.size());
  for (std::size_t m = 0; m < needs.size(); ++m)
    for (const std::uint32_t set : uv_sets_of(file.materials[m])) {
      if (set == 0 && !file.mesh.corner_uvs.empty()) continue;
      const auto uvs = std::ranges::find(file.attributes, fmt::format("uv{}", set), &MeshAttribute::name);
      const bool usable = uvs != file.attributes.end() && uvs->rows && uvs->components == 2;
      needs[m].push_back({.set = set, .uvs = usable ? &*uvs : nullptr});
    }
  for (std::size_t f = 0; f < file.face_materials.size(); ++f) {
    if (file.face_materials[f] == kNone) continue;
    for (Need& need : needs[file.face_materials[f]]) {
      const auto has_coordinates = [&](std::uint32_t row) {
        return row != kNone && std::isfinite(need.uvs->values[2 * std::size_t{row}]) &&
               std::isfinite(need.uvs->values[2 * std::size_t{row} + 1]);
      };
      if (need.uvs == nullptr || !std::ranges::all_of((*need.uvs->rows)[f], has_coordinates)) ++need.faces;
    }
  }
  for (std::size_t m = 0; m < needs.size(); ++m)
    for (const Need& need : needs[m])
      if (need.faces > 0)
        file.notes.push_back(
            fmt::format("textures of {} are left out on {} faces without texture coordinates{}",
                        excerpt(file.materials[m].name), need.faces,
                        need.set == 0 ? "" : fmt::format(" of set {}", need.set)));
}

}  // namespace

MeshFile to_mesh_file(PolygonMesh polygons, const MeshFileOptions& options) {
  std::vector<std::uint32_t> renumbered, triangle_ends;
  std::vector<Triangle> places;
  MeshFile result{
      .mesh = to_mesh(polygons, renumbered, triangle_ends, options.attributes ? &places : nullptr),
      .names = {},
      .notes = std::move(polygons.notes)};
  if (std::string fault = uv_fault(polygons); !fault.empty() && !options.attributes)
    result.notes.push_back(std::move(fault));
  validate(result.mesh);
  add_names("object", polygons.objects, triangle_ends, result.names);
  add_names("group", polygons.groups, triangle_ends, result.names);
  add_names("material", polygons.materials, triangle_ends, result.names);
  add_names("face", polygons.faces, triangle_ends, result.names);
  add_names("color", polygons.colors, triangle_ends, result.names);
  if (options.attributes) result.attributes = to_attributes(polygons, places, triangle_ends, result.notes);
  if (!polygons.surfaces.list.empty())
    result.face_materials = materials_of_triangles(polygons.surfaces, triangle_ends);
  result.materials = std::move(polygons.surfaces.list);
  result.textures = std::move(polygons.surfaces.textures);
  if (!result.textures.empty() && has_one_uv(result.mesh))
    result.notes.push_back("all texture coordinates are the same: each texture has one colour");
  if (!result.textures.empty()) note_missing_coordinates(result);
  result.tessellation = std::move(polygons.tessellation);
  if (options.vertices)
    result.vertices = FileVertices{.positions = std::move(polygons.positions),
                                   .mesh_vertex = std::move(renumbered),
                                   .corners = std::move(polygons.corners),
                                   .ends = std::move(polygons.ends)};
  return result;
}

}  // namespace sdm::io
