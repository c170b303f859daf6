#include <sdm/bake.h>
#include <sdm/error.h>
#include <sdm/mesh_attributes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <string>
#include <utility>

#include "baking/look_reader.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "map/transfer/fill_texels.h"

namespace sdm {
namespace {

using baking::ChannelLook;
using map::TexelState;

constexpr std::size_t kRowsOfRange = 8;

std::vector<float> values_of(const ChannelLook& look, const Surface& surface, const TexelMatches& matches,
                             const Progress& progress) {
  const std::uint32_t resolution = matches.resolution;
  const auto owners = surface.texel_faces();
  std::vector<float> values(owners.size() * look.components, std::numeric_limits<float>::quiet_NaN());
  parallel_for(surface.rows(), kRowsOfRange, progress, "bake", [&](std::size_t begin, std::size_t end) {
    baking::LookReader reader(look);
    std::uint32_t owner = kNone;
    std::array<Vec3, 2> sides{};
    for (std::size_t i = begin * resolution; i < end * resolution; ++i) {
      if (matches.face[i] == kNone) continue;
      if (owners[i] != owner) {
        owner = owners[i];
        sides = surface.texel_edges(owner);
      }
      reader.at(matches.point(i), sides, &values[i * look.components]);
    }
  });
  return values;
}

std::vector<TexelState> states_of(const TexelMatches& matches) {
  std::vector<TexelState> states(matches.face.size());
  std::ranges::transform(matches.face, states.begin(), [](std::uint32_t face) {
    return face == kNone ? TexelState::free : TexelState::valued;
  });
  return states;
}

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

std::string_view name_of(BakeChannel channel) {
  switch (channel) {
    case BakeChannel::base_color:
      return "base_color";
    case BakeChannel::metallic_roughness:
      return "metallic_roughness";
    case BakeChannel::occlusion:
      return "occlusion";
    case BakeChannel::emissive:
      return "emissive";
  }
  return {};
}

std::vector<BakeChannel> varying_channels(const Mesh& mesh, const MeshLook& look) {
  baking::require_fitting(mesh, look);
  const auto used = baking::used_materials(look);
  const auto textured = [&](TextureUse Material::*use) {
    return std::ranges::any_of(used, [&](const Material* m) {
      return (m->*use).texture != kNone && look.pictures[(m->*use).texture].width > 0;
    });
  };
  const auto differ = [&](auto Material::*factor) {
    return std::ranges::any_of(used, [&](const Material* m) { return m->*factor != used.front()->*factor; });
  };
  const bool colors = std::ranges::count(look.attributes, "color", &MeshAttribute::name) > 0;
  std::vector<BakeChannel> channels;
  if (colors || textured(&Material::base_color_texture) || differ(&Material::base_color) ||
      differ(&Material::alpha_mode))
    channels.push_back(BakeChannel::base_color);
  if (textured(&Material::metallic_roughness_texture) || differ(&Material::metallic) ||
      differ(&Material::roughness))
    channels.push_back(BakeChannel::metallic_roughness);
  if (textured(&Material::occlusion_texture)) channels.push_back(BakeChannel::occlusion);
  if (textured(&Material::emissive_texture) || differ(&Material::emissive))
    channels.push_back(BakeChannel::emissive);
  return channels;
}

std::vector<BakeChannel> default_channels(const Mesh& mesh, const MeshLook& look) {
  std::vector<BakeChannel> channels = varying_channels(mesh, look);
  if (std::ranges::count(channels, BakeChannel::base_color) == 0)
    channels.insert(channels.begin(), BakeChannel::base_color);
  return channels;
}

Material common_material(const MeshLook& look) {
  Material material;
  baking::require_materials(look);
  const auto used = baking::used_materials(look);
  if (used.empty()) return material;
  material = *used.front();
  for (const Material* other : used)
    if (material.alpha_mode == AlphaMode::opaque && other->alpha_mode != AlphaMode::opaque) {
      material.alpha_mode = other->alpha_mode;
      material.alpha_cutoff = other->alpha_cutoff;
    }
  material.name.clear();
  for (TextureUse Material::*use :
       {&Material::base_color_texture, &Material::metallic_roughness_texture, &Material::normal_texture,
        &Material::occlusion_texture, &Material::emissive_texture})
    material.*use = {};
  return material;
}

std::vector<BakedChannel> bake(const Surface& surface, const Sites& sites, const TexelMatches& matches,
                               const MeshLook& look, std::span<const BakeChannel> channels,
                               const BakeOptions& options) try {
  require_matches(surface, sites, matches);
  baking::require_fitting(sites.mesh(), look);
  constexpr std::size_t kMostNumbers = 4, kWithFilling = 2;  // of a texel
  require_memory(channels.size() * matches.kind.size() * kMostNumbers * kWithFilling * sizeof(float),
                 "baking these textures");
  baking::Pictures pictures(look);
  const std::vector<TexelState> states = options.fill ? states_of(matches) : std::vector<TexelState>();
  std::vector<BakedChannel> baked;
  for (const BakeChannel channel : channels) {
    const ChannelLook of_channel(sites.mesh(), look, channel, pictures);
    BakedChannel& result = baked.emplace_back(channel, matches.resolution, of_channel.components,
                                              values_of(of_channel, surface, matches, options.progress));
    if (std::vector<TexelState> filled = states; options.fill)
      map::fill_free_texels(matches.resolution, filled, map::gutter_of_values(surface.gutter()),
                            result.components, result.values);
  }
  return baked;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the baked textures");
}

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
