// What a mesh looks like at points of its faces.
#pragma once

#include <sdm/bake.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "baking/mip_chain.h"

namespace sdm::baking {

/// The pictures of a look that channels use, ready to be sampled.
class Pictures {
 public:
  explicit Pictures(const MeshLook& look) : look_(look) {}

  /// The picture of a texture, or null if there is none. Prepares it when it is first asked for: not from
  /// several threads.
  [[nodiscard]] const MipChain* prepare(const TextureUse& use, bool srgb);

 private:
  const MeshLook& look_;
  std::map<std::pair<std::uint32_t, bool>, std::unique_ptr<MipChain>> chains_;
};

/// Texture coordinates of the corners of faces; or none.
struct UvSet {
  const Mesh* mesh = nullptr;                ///< of corner_uvs
  const MeshAttribute* attribute = nullptr;  ///< else

  /// Returns whether the face has them.
  bool read(std::uint32_t face, std::array<Vec2, 3>& uvs) const;
};

/// A channel of a look: what its materials multiply.
struct ChannelLook {
  /// What one material has in the channel; the last layer is that of faces without a material.
  struct Layer {
    const Material* material;
    const MipChain* picture;  ///< or null
    TextureUse use;
    UvSet uvs;
  };

  /// The look must fit the mesh; see require_fitting(). All must outlive this.
  ChannelLook(const Mesh& mesh, const MeshLook& look, BakeChannel channel, Pictures& pictures);
  /// The textures of another kind, plain numbers, for LookReader::texel(). Of channels, there is none.
  ChannelLook(const Mesh& mesh, const MeshLook& look, TextureUse Material::*texture, Pictures& pictures);

  [[nodiscard]] const Layer& layer_of(std::uint32_t face) const {
    const std::uint32_t number = look.face_materials.empty() ? kNone : look.face_materials[face];
    return number == kNone ? layers.back() : layers[number];
  }

  const Mesh& mesh;
  const MeshLook& look;
  BakeChannel channel;
  std::size_t components;
  std::vector<Layer> layers;
  const MeshAttribute* vertex_colors = nullptr;  ///< of base_color

 private:
  void add_layers(TextureUse Material::*texture, bool srgb, Pictures& pictures);
};

/// Reads a channel at points. Consecutive points often lie on the same face, whose data are kept: each thread
/// needs a reader of its own.
class LookReader {
 public:
  explicit LookReader(const ChannelLook& look) : look_(&look) {}

  /// Sets the components of `values` at a point of a face, averaged over the parallelogram of the sides.
  void at(const SurfacePoint& point, const std::array<Vec3, 2>& sides, float* values);
  /// The texture alone, red, green, blue and alpha; nothing where there is none.
  [[nodiscard]] std::optional<std::array<float, 4>> texel(const SurfacePoint& point,
                                                          const std::array<Vec3, 2>& sides);

 private:
  void read_face(std::uint32_t face);
  [[nodiscard]] std::array<float, 4> texture(const SurfacePoint& point,
                                             const std::array<Vec3, 2>& sides) const;
  [[nodiscard]] std::array<float, 4> vertex_color(const SurfacePoint& point) const;

  const ChannelLook* look_;
  std::uint32_t face_ = kNone;
  const ChannelLook::Layer* layer_ = nullptr;
  bool textured_ = false;
  std::array<Vec2, 3> pixels_{};       ///< of the corners, in the picture
  std::array<Vec3, 2> derivatives_{};  ///< of x and y in the picture, by points of the plane of the face
};

/// The texture of a channel.
[[nodiscard]] TextureUse Material::*texture_of(BakeChannel channel);

/// Throws sdm::Error if the look does not fit the mesh.
void require_fitting(const Mesh& mesh, const MeshLook& look);

/// Throws sdm::Error if a face refers to a material that does not exist.
void require_materials(const MeshLook& look);

/// The materials that faces have; null: that of Material().
[[nodiscard]] std::vector<const Material*> used_materials(const MeshLook& look);

}  // namespace sdm::baking
