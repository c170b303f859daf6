#include <sdm/bake.h>
#include <sdm/error.h>
#include <sdm/mesh_attributes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace sdm {
namespace {

// The share of the texels of faces that another face may want. Rounding and slivers have less.
constexpr double kMostOverlap = 0.01;

// Whether all lie in [0, 1] but for rounding.
bool in_unit_square(const Mesh& mesh) {
  constexpr double kMost = 1e6;  // of uv_tiles()
  for (const auto& uvs : mesh.corner_uvs)
    for (const Vec2& uv : uvs)
      if (!(std::abs(uv[0]) < kMost && std::abs(uv[1]) < kMost)) return false;
  return uv_tiles(mesh).is_unit_square();
}

Surface laid_out_as(const Mesh& mesh, AtlasOptions options, AtlasKind kind) {
  options.kind = kind;
  return Surface(mesh, options);
}

}  // namespace

double overlap_of(const Surface& surface) {
  return static_cast<double>(surface.overlapping_texels()) / static_cast<double>(surface.owned_texels());
}

BakeAtlas bake_atlas(const Mesh& mesh, const AtlasOptions& options) {
  std::string fault;
  if (mesh.corner_uvs.empty()) {
    fault = "it has no UVs";
  } else if (has_one_uv(mesh)) {
    fault = "its UVs are all the same";
  } else if (!in_unit_square(mesh)) {
    fault = "its UVs leave [0, 1]";
  } else {
    try {
      Surface surface = laid_out_as(mesh, options, AtlasKind::uv);
      if (!(overlap_of(surface) > kMostOverlap)) return {std::move(surface), {}};
      fault = "faces overlap in its UVs";
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {  // they overlap too often to be laid out, or no face has a texel
      fault = std::string("its UVs cannot be used: ") + error.what();
    }
  }
  if (options.rows && *options.rows != options.resolution)
    throw Error("textures that are not square need UVs that can be used, but " + fault);
  return {laid_out_as(mesh, options, AtlasKind::charts), fault};
}

}  // namespace sdm
