#include "bake_surface.h"

#include <fmt/format.h>
#include <sdm/bake.h>

#include <utility>

#include "format.h"
#include "notes.h"

namespace {

void add_note_on_faces(const Input& low, const sdm::Surface& surface, Notes& notes) {
  const std::size_t faces = surface.faces_without_uv_area();
  if (faces == 0) return;
  notes.push_back(
      fmt::format("{}: {} of {} faces {} no area in the UVs, so no texel: the texture shows on them what "
                  "lies at their UVs",
                  low.file, faces, low.mesh.triangles.size(), faces == 1 ? "has" : "have"));
}

}  // namespace

BakeSurface bake_surface(const Input& low, const sdm::BakeRequest& request) {
  BakeSurface result;
  const sdm::AtlasOptions layout = sdm::sample_layout(request);
  if (!request.atlas) {
    sdm::BakeAtlas atlas = sdm::bake_atlas(low.mesh, layout);
    const bool usable = !low.mesh.corner_uvs.empty() && !atlas.fault.starts_with("its UVs cannot be used");
    if (!atlas.fault.empty())
      result.notes.push_back(fmt::format("{}: {}, so it got an atlas of charts{}", low.file, atlas.fault,
                                         usable ? "; --atlas uv uses them" : ""));
    result.surface = std::make_unique<sdm::Surface>(std::move(atlas.surface));
    add_note_on_faces(low, *result.surface, result.notes);
    return result;
  }
  result.surface = std::make_unique<sdm::Surface>(low.mesh, layout);
  if (const double overlap = sdm::overlap_of(*result.surface); overlap > 0)
    result.notes.push_back(fmt::format(
        "{}: {} % of the texels of faces lie in another face too: each has what its first face has", low.file,
        number(100 * overlap, 2)));
  add_note_on_faces(low, *result.surface, result.notes);
  return result;
}
