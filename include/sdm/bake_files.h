/// The files of baking: pictures of textures, and models that contain them. Every function throws an
/// sdm::Error that names the file and the fault.
///
/// Threads: the functions may be called concurrently, unless two of them write the same file.
#pragma once

#include <sdm/api.h>
#include <sdm/bake.h>
#include <sdm/image.h>
#include <sdm/io.h>
#include <sdm/material.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sdm {

/// decode_image() of the textures that these channels need of a look, whose pictures do not matter, for
/// MeshLook::pictures; others become empty images, and so do damaged ones, with a line in `notes`. Throws
/// sdm::Error if a face or a material refers to what does not exist, and if there is not enough memory. Cost:
/// linear, all cores, a core for each picture.
[[nodiscard]] SDM_API std::vector<Image> decode_textures(std::span<const TextureFile> textures,
                                                         const MeshLook& look,
                                                         std::span<const BakeChannel> channels,
                                                         std::vector<std::string>& notes);

/// A channel as a picture: encode_png(to_image()) of it.
struct BakedTexture {
  BakeChannel channel = BakeChannel::base_color;
  std::vector<char> png;
};

/// Options of write_baked_glb().
struct BakedModelOptions {
  Material material{};    ///< the factors of what has no texture, and what alpha means
  std::string units{};    ///< as of write_glb()
  UpAxis up = UpAxis::y;  ///< as of write_glb()
  /// Three components at each corner of O1's faces; null: smooth except across edges of more than 40°.
  const MeshAttribute* normals = nullptr;
  /// A PNG of normal_map_image(), and the tangents() that it was made with, from the same normals; or
  /// neither.
  std::span<const char> normal_map{};
  const MeshAttribute* tangents = nullptr;
};

/// A model of O1 with textures on its atlas, in one lit material. Any viewer displays it. Also throws
/// sdm::Error if the model exceeds 4 GB, and if there is not enough memory. Cost: linear.
SDM_API void write_baked_glb(const std::filesystem::path& file, const Surface& surface,
                             std::span<const BakedTexture> textures, const BakedModelOptions& options = {});

}  // namespace sdm
