/// Materials of meshes, with the textures that files refer to.
///
/// Threads: plain values.
#pragma once

#include <sdm/names.h>
#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace sdm {

/// What a texture has outside of [0, 1].
enum class TextureWrap : std::uint8_t {
  repeat,  ///< copies of it
  mirror,  ///< copies of it, every other one mirrored
  clamp,   ///< its border
};

/// A texture on faces.
struct TextureUse {
  std::uint32_t texture = kNone;  ///< of MeshFile::textures; kNone: there is none
  std::uint32_t uv_set = 0;       ///< 0: Mesh::corner_uvs; n: the attribute `uv<n>`
  /// The affine map, by rows, from texture coordinates to places in the texture: (0, 0) at its lower left,
  /// (1, 1) at its upper right.
  std::array<std::array<double, 3>, 2> place{{{1, 0, 0}, {0, 1, 0}}};
  std::array<TextureWrap, 2> wrap{};  ///< along u and v

  friend bool operator==(const TextureUse&, const TextureUse&) = default;
};

/// What the alpha of a base colour means.
enum class AlphaMode : std::uint8_t {
  opaque,  ///< nothing
  mask,    ///< below alpha_cutoff there is no surface
  blend,   ///< the share of its light; the rest is what is behind
};

template <>
inline constexpr std::array kWords<AlphaMode>{"opaque", "mask", "blend"};

/// A surface as glTF describes it (metallic-roughness), which textures multiply. Numbers are from 0 to 1, of
/// light linear.
struct Material {
  std::string name;
  std::array<float, 4> base_color{1, 1, 1, 1};  ///< red, green, blue, alpha
  std::array<float, 3> emissive{};
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  float metallic = 0, roughness = 1;
  float normal_scale = 1;                 ///< of x and y of normal_texture
  float occlusion_strength = 1;           ///< 0: occlusion_texture has no effect
  TextureUse base_color_texture;          ///< sRGB, and alpha
  TextureUse metallic_roughness_texture;  ///< roughness in green, metallic in blue
  TextureUse normal_texture;              ///< of tangent space, (1 + x) / 2
  TextureUse occlusion_texture;           ///< in red
  TextureUse emissive_texture;            ///< sRGB
};

/// A picture that materials refer to, as it is stored: decode_image() reads it.
struct TextureFile {
  std::string name;         ///< of its file, or of the picture in the file of the mesh
  std::vector<char> bytes;  ///< PNG, JPEG or WebP
};

}  // namespace sdm
