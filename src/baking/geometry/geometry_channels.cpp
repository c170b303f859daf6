#include <sdm/bake.h>
#include <sdm/error.h>

#include <new>
#include <optional>
#include <string>

#include "core/memory.h"

namespace sdm {
namespace {

std::vector<float> baked_normals(const Surface& surface, const Sites& sites, const TexelMatches& matches,
                                 const GeometryOptions& options) {
  std::optional<MeshAttribute> smooth;
  if (options.normals == nullptr) smooth = smooth_normals(sites.mesh());
  return matched_normals(surface, sites, matches, smooth ? *smooth : *options.normals, options.progress,
                         options.look);
}

std::vector<float> baked_displacements(const Surface& surface, const Sites& sites,
                                       const TexelMatches& matches, const GeometryOptions& options) {
  std::optional<MeshAttribute> smooth;
  if (options.directions == nullptr) smooth = smooth_normals(surface.mesh());
  return matched_displacements(surface, sites, matches, smooth ? *smooth : *options.directions,
                               options.progress);
}

}  // namespace

std::string_view name_of(GeometryChannel channel) {
  switch (channel) {
    case GeometryChannel::normal:
      return "normal";
    case GeometryChannel::object_normal:
      return "object_normal";
    case GeometryChannel::displacement:
      return "displacement";
    case GeometryChannel::position:
      return "position";
    case GeometryChannel::ambient_occlusion:
      return "ambient_occlusion";
    case GeometryChannel::thickness:
      return "thickness";
    case GeometryChannel::face:
      return "face";
    case GeometryChannel::material:
      return "material";
  }
  return {};
}

std::vector<std::uint32_t> matched_materials(const Surface& surface, const Sites& sites,
                                             const TexelMatches& matches,
                                             std::span<const std::uint32_t> face_materials) try {
  require_matches(surface, sites, matches);
  const std::size_t faces = sites.mesh().triangles.size();
  if (!face_materials.empty() && face_materials.size() != faces)
    throw Error("a mesh of " + std::to_string(faces) + " faces needs as many numbers of materials, not " +
                std::to_string(face_materials.size()));
  require_memory(matches.face.size() * sizeof(std::uint32_t), "the materials of matches");
  std::vector<std::uint32_t> materials(matches.face.size(), kNone);
  if (face_materials.empty()) return materials;
  for (std::size_t i = 0; i < materials.size(); ++i)
    if (matches.face[i] != kNone) materials[i] = face_materials[matches.face[i]];
  return materials;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the materials of matches");
}

std::vector<float> bake_geometry(const Surface& surface, const Sites& sites, const TexelMatches& matches,
                                 GeometryChannel channel, const GeometryOptions& options) {
  AmbientOcclusionOptions occlusion = options.occlusion;
  ThicknessOptions thickness = options.thickness;
  occlusion.progress = thickness.progress = options.progress;
  switch (channel) {
    case GeometryChannel::normal:
      if (options.drawn_normals == nullptr || options.drawn_tangents == nullptr)
        throw Error("normals in tangent space need the normals and tangents that the model is drawn with");
      return tangent_space_normals(surface, *options.drawn_normals, *options.drawn_tangents,
                                   baked_normals(surface, sites, matches, options), options.progress);
    case GeometryChannel::object_normal:
      return baked_normals(surface, sites, matches, options);
    case GeometryChannel::displacement:
      return baked_displacements(surface, sites, matches, options);
    case GeometryChannel::position:
      return matched_positions(surface, sites, matches, options.progress);
    case GeometryChannel::ambient_occlusion:
      return matched_occlusion(surface, sites, matches, occlusion).values;
    case GeometryChannel::thickness:
      return matched_thickness(surface, sites, matches, options.method, thickness);
    case GeometryChannel::face:
    case GeometryChannel::material:
      break;
  }
  throw Error("the channel `" + std::string(name_of(channel)) + "` has whole numbers");
}

}  // namespace sdm
