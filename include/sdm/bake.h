/// Baking: what the materials, textures and colours of O2 are at the points that belong to O1's texels, as
/// textures of O1.
///
/// Threads: the functions may be called concurrently, also with the same surface, sites and matches.
#pragma once

#include <sdm/api.h>
#include <sdm/image.h>
#include <sdm/match.h>
#include <sdm/material.h>
#include <sdm/mesh_attributes.h>
#include <sdm/progress.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sdm {

/// The textures of a material that can be baked.
enum class BakeChannel : std::uint8_t {
  base_color,  ///< red, green, blue, and alpha unless all is opaque: factor · texture · vertex colour
  metallic_roughness,  ///< roughness and metallic: factor · texture
  occlusion,           ///< the share of ambient light that arrives: 1 + strength · (texture − 1)
  emissive,            ///< red, green, blue: factor · texture
};

/// All of them, in this order.
inline constexpr BakeChannel kBakeChannels[] = {BakeChannel::base_color, BakeChannel::metallic_roughness,
                                                BakeChannel::occlusion, BakeChannel::emissive};

/// Returns the name of a channel, such as "base_color".
[[nodiscard]] SDM_API std::string_view name_of(BakeChannel channel);

/// Whether the values of a channel are colours, which pictures store in sRGB.
[[nodiscard]] constexpr bool is_color(BakeChannel channel) {
  return channel == BakeChannel::base_color || channel == BakeChannel::emissive;
}

/// How the faces of a mesh look: of a MeshFile its arrays, with the pictures decoded.
struct MeshLook {
  std::span<const Material> materials{};
  /// The material of each face, or kNone: that of Material(). Empty: kNone for all.
  std::span<const std::uint32_t> face_materials{};
  /// The pictures that materials refer to. An empty one (width 0): there is no such texture.
  std::span<const Image> pictures{};
  /// `color` multiplies base colours; `uv1`, `uv2`, ... are further texture coordinates, `uv0`
  /// the first ones if the mesh has none. Others are ignored.
  std::span<const MeshAttribute> attributes{};
};

/// Returns the channels that differ between points of the mesh: those with a texture, with factors that are
/// not the same for all faces, or with colours of vertices. Throws sdm::Error as bake() does. Cost: linear in
/// faces.
[[nodiscard]] SDM_API std::vector<BakeChannel> varying_channels(const Mesh& mesh, const MeshLook& look);

/// Returns the channels that are baked unless others are asked for: base_color, and the others of
/// varying_channels(). Errors and cost as there.
[[nodiscard]] SDM_API std::vector<BakeChannel> default_channels(const Mesh& mesh, const MeshLook& look);

/// Returns the material of the first face that has one, or Material(), without name and textures: the factors
/// of channels that do not differ. Its alpha_mode is `blend` or `mask` if that of any face is. Throws
/// sdm::Error for a number of a material that does not exist.
[[nodiscard]] SDM_API Material common_material(const MeshLook& look);

/// A surface for textures.
struct BakeAtlas {
  Surface surface;
  std::string fault;  ///< why its UVs are not used, such as "it has no UVs"; empty: they are
};

/// Lays a mesh out for textures: by its UVs if it has them, they lie in [0, 1], and at most 1 % of the texels
/// of faces lie in another one too; otherwise in charts. `options.kind` is ignored. Throws sdm::Error as
/// Surface does, and for a texture that is not square if the UVs cannot be used. Cost: that of one or two
/// surfaces.
[[nodiscard]] SDM_API BakeAtlas bake_atlas(const Mesh& mesh, const AtlasOptions& options = {});

/// Returns Surface::overlapping_texels() as a share of the texels of faces.
[[nodiscard]] SDM_API double overlap_of(const Surface& surface);

/// Options of bake().
struct BakeOptions {
  /// Whether texels without a match get values too, as of TransferOptions::fill; otherwise they hold NaN.
  bool fill = true;
  Progress progress{};
};

/// A channel of O1's texels.
struct BakedChannel {
  BakeChannel channel = BakeChannel::base_color;
  std::uint32_t resolution = 0;  ///< texels per row
  std::size_t components = 0;    ///< 3 or 4 of base_color, 2, 1, 3
  std::vector<float> values;     ///< row after row, from 0 to 1; colours in linear light
};

/// Returns the channels at the matches of the texels. A texture is averaged over what the texel covers of it:
/// the texel's edges, projected onto the plane of the face of O2 and carried to the texture by the face's
/// texture coordinates. Colours are averaged in linear light; colours of vertices are interpolated. Where
/// O2 has no texture coordinates for a texture, its factor alone counts.
///
/// Throws sdm::Error if the matches are not those of the surface, if a number of a face, a material or a
/// picture does not exist, for arrays of another mesh than that of the sites, and if there is not enough
/// memory; Cancelled. Cost: linear in texels and in pixels of the pictures that are used, all cores; twice
/// the memory of the pictures.
[[nodiscard]] SDM_API std::vector<BakedChannel> bake(const Surface& surface, const Sites& sites,
                                                     const TexelMatches& matches, const MeshLook& look,
                                                     std::span<const BakeChannel> channels,
                                                     const BakeOptions& options = {});

/// A channel at points: `components` numbers for each, as in BakedChannel.
struct LookValues {
  std::size_t components = 0;
  std::vector<float> values;
};

/// Returns a channel of a mesh at points of its faces. A texture is averaged over a square in the plane of
/// the face, whose middle is the point and whose sides are as long as `extent`, at least 0. Throws sdm::Error
/// as bake() does, and for a point of a face that does not exist. Cost: linear in points and in pixels of the
/// pictures that are used, all cores.
[[nodiscard]] SDM_API LookValues look_at(const Mesh& mesh, const MeshLook& look, BakeChannel channel,
                                         std::span<const SurfacePoint> points, double extent = 0);

/// Returns a channel with 8 bits a number, as textures of glTF have it: colours in sRGB, roughness in green
/// and metallic in blue beside a red of 1, occlusion in grey. Texels without a value are black. Throws
/// sdm::Error unless the values are whole rows of texels, of two numbers for roughness and metallic. Cost:
/// linear, all cores.
[[nodiscard]] SDM_API Image to_image(const BakedChannel& baked);

}  // namespace sdm
