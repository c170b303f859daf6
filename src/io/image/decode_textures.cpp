#include <fmt/format.h>
#include <sdm/bake_files.h>
#include <sdm/error.h>
#include <sdm/execution.h>

#include <cstdint>
#include <functional>
#include <new>
#include <set>

#include "baking/look_reader.h"
#include "core/excerpt.h"
#include "core/memory.h"
#include "io/image/textures/decoders.h"

namespace sdm {
namespace {

// A file of some kilobytes can have as many pixels as take gigabytes: all textures together may have those of
// two pictures of 8192 x 8192, and more where their files are larger.
void check_pixels(std::span<const TextureFile> textures, const std::set<std::uint32_t>& needed) {
  constexpr std::size_t kMost = std::size_t{1} << 27, kOfEachByte = 64;
  std::size_t most = kMost, pixels = 0;
  for (const std::uint32_t i : needed) most += kOfEachByte * textures[i].bytes.size();
  for (const std::uint32_t i : needed) {
    const std::size_t more = io::pixels_of(textures[i].bytes);
    pixels += more;
    if (pixels > most)
      throw Error(
          fmt::format("the texture {}: its {} pixels are too many in {} bytes: textures may have 2^27 pixels "
                      "together, and {} for each byte of their files",
                      excerpt(textures[i].name), more, textures[i].bytes.size(), kOfEachByte));
  }
}

}  // namespace

std::vector<Image> decode_textures(std::span<const TextureFile> textures, const MeshLook& look,
                                   std::span<const BakeChannel> channels, std::vector<std::string>& notes,
                                   bool normals) try {
  for (const std::uint32_t material : look.face_materials)
    if (material != kNone && material >= look.materials.size())
      throw Error(fmt::format("a face refers to material {} of {}", material, look.materials.size()));
  std::set<std::uint32_t> needed;
  const auto need = [&](const TextureUse& use) {
    if (use.texture != kNone) needed.insert(use.texture);
  };
  for (const Material* material : baking::used_materials(look)) {
    for (const BakeChannel channel : channels) need(material->*baking::texture_of(channel));
    if (normals) need(material->normal_texture);
  }
  if (!needed.empty() && *needed.rbegin() >= textures.size())
    throw Error(fmt::format("a material refers to texture {} of {}", *needed.rbegin(), textures.size()));
  check_pixels(textures, needed);
  std::vector<Image> images(textures.size());
  std::vector<std::string> faults(textures.size());
  std::vector<std::function<void()>> tasks;
  for (const std::uint32_t i : needed)
    tasks.emplace_back([&, i] {
      try {
        images[i] = decode_image(textures[i].bytes);
      } catch (const Cancelled&) {
        throw;
      } catch (const io::PictureTooLarge& error) {
        throw Error(fmt::format("the texture {}: {}", excerpt(textures[i].name), error.what()));
      } catch (const Error& error) {
        faults[i] = error.what();
      }
    });
  run_concurrently(tasks);
  for (std::size_t i = 0; i < textures.size(); ++i)
    if (!faults[i].empty())
      notes.push_back(fmt::format("the texture {} is left out: {}", excerpt(textures[i].name), faults[i]));
  return images;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the textures");
}

}  // namespace sdm
