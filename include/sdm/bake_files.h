/// The files of baking: pictures of textures, decoded and encoded, and models that contain them. Those
/// of files throw an sdm::Error that names the file and the fault.
///
/// Threads: the functions may be called concurrently, unless two of them write the same file.
#pragma once

#include <sdm/bake.h>
#include <sdm/map_files.h>
#include <sdm/mesh.h>
#include <sdm/mesh_attributes.h>
#include <sdm/surface.h>
#include <sdm/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sdm {

/// Decodes a PNG, JPEG or WebP file, by its content. Palettes become colours, fewer bits than 8 become 8, and
/// CMYK becomes red, green and blue, as without a colour profile. Colour profiles and gamma are ignored, as
/// glTF has it. Throws sdm::Error for other formats, for damaged and truncated files, for more than 100,000
/// pixels a side or 2^28 in total, and if there is not enough memory. Cost: linear in pixels.
[[nodiscard]] SDM_API Image decode_image(std::span<const char> bytes);

/// decode_image() of a file, whose name the errors begin with.
[[nodiscard]] SDM_API Image read_image(const std::filesystem::path& file);

/// Returns a PNG file with these pixels; `srgb`: colours (of three or four components) are stated to be in
/// sRGB. Made for speed rather than size. Throws sdm::Error if the picture has no pixels or its bytes are not
/// those of its pixels, and if there is not enough memory. Cost: linear, all cores.
[[nodiscard]] SDM_API std::vector<char> encode_png(const Image& image, bool srgb = true);

/// decode_image() of the textures that these channels, and `normals`, need of a look, whose pictures do not
/// matter, for MeshLook::pictures; others become empty images, and so do damaged ones, with a line in
/// `notes`. Throws sdm::Error if a face or a material refers to what does not exist, if these textures have
/// more than 2^27 pixels and 64 for each byte of their files, and if there is not enough memory. Cost:
/// linear, all cores, a core for each picture.
[[nodiscard]] SDM_API std::vector<Image> decode_textures(std::span<const TextureFile> textures,
                                                         const MeshLook& look,
                                                         std::span<const BakeChannel> channels,
                                                         std::vector<std::string>& notes,
                                                         bool normals = false);

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
  /// Three components at each corner of O1's faces; null: smooth_normals() of kDrawnCrease.
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

/// The O2 of a DetailedView.
struct BakedFrom {
  const Mesh& mesh;
  const MeshLook& look;
  const MeshAttribute* normals = nullptr;  ///< at the corners of its faces; null: smooth_normals()
};

/// O2 as write_baked_html() shows it: with colours at its vertices. Faces with a texture are divided for
/// them, and of more than 250,000 faces, a coarser copy is shown; the page states which. No textures of O1
/// are needed, so that it can be made while they are baked.
class SDM_API DetailedView {
 public:
  /// `o1`: the mesh that it is shown beside, in one box with it. Throws sdm::Error if the normals or the look
  /// do not fit the mesh, if there is not enough memory, and if can_write_html() is false. Cost: linear, all
  /// cores.
  DetailedView(const BakedFrom& from, const Mesh& o1);

  struct Data;  ///< of the library's own
  /// What write_baked_html() writes.
  [[nodiscard]] const Data& data() const { return *data_; }

 private:
  std::shared_ptr<const Data> data_;
};

/// report.html: one file that opens in a browser, from disk and without a network. It shows O1 with its
/// textures and O2 under one camera, with a slider between them, and the numbers of `report`, the JSON text
/// of report.json. `textures` and `options` are those of write_baked_glb(), of any size; `o2` was made for
/// the surface's mesh. Also throws sdm::Error if can_write_html() is false. Cost: linear, all cores.
SDM_API void write_baked_html(const std::filesystem::path& file, const Surface& surface,
                              std::span<const BakedTexture> textures, const BakedModelOptions& options,
                              const DetailedView& o2, const std::string& report);

/// Numbers of texels, of which one file has several planes: values, or else whole numbers.
struct TexelPlane {
  std::string name;                          ///< such as "position.X"
  std::span<const float> values{};           ///< FLOAT
  std::span<const std::uint32_t> numbers{};  ///< UINT
  std::size_t components = 1;                ///< for each texel,
  std::size_t component = 0;                 ///< of which the plane has this one
};

/// An OpenEXR file of planes as they are, row 0 at the top: rows of `resolution` texels. `attributes`: as
/// ExrOptions::attributes. Also throws sdm::Error unless all planes are the same whole rows, and if there is
/// not enough memory. Cost: linear, all cores.
SDM_API void write_exr(const std::filesystem::path& file, std::uint32_t resolution,
                       std::span<const TexelPlane> planes,
                       const std::vector<std::pair<std::string, std::string>>& attributes = {});

}  // namespace sdm
