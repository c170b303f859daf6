#include "io/mesh/model/gltf_material.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "io/mesh/split_vertices.h"

namespace sdm::io {
namespace {

const char* name_in_gltf(AlphaMode mode) {
  switch (mode) {
    case AlphaMode::opaque:
      break;
    case AlphaMode::mask:
      return "MASK";
    case AlphaMode::blend:
      return "BLEND";
  }
  return "OPAQUE";
}

template <class Factors>
std::vector<double> in_unit_range(const Factors& factors) {
  std::vector<double> result;
  for (const float factor : factors) result.push_back(std::clamp(double{factor}, 0.0, 1.0));
  return result;
}

int wrap_in_gltf(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::repeat:
      break;
    case TextureWrap::mirror:
      return TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT;
    case TextureWrap::clamp:
      return TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
  }
  return TINYGLTF_TEXTURE_WRAP_REPEAT;
}

// KHR_texture_transform, whose v points down: offset + rotation · scale, the inverse of reading it. A map
// that shears has no such form; the nearest one is written.
tinygltf::Value transform_of(const TextureUse& use) {
  const auto& [s, t] = use.place;
  const double uu = s[0], uv = -s[1], vu = -t[0], vv = t[1];
  const double angle = std::atan2(-vu, uu), c = std::cos(angle), sine = std::sin(angle);
  const auto pair = [](double a, double b) {
    return tinygltf::Value(tinygltf::Value::Array{tinygltf::Value(a), tinygltf::Value(b)});
  };
  return tinygltf::Value(tinygltf::Value::Object{{"offset", pair(s[2] - uv, 1 - t[2] - vv)},
                                                 {"rotation", tinygltf::Value(angle)},
                                                 {"scale", pair(std::hypot(uu, vu), sine * uv + c * vv)}});
}

class MaterialWriter {
 public:
  MaterialWriter(GlbModel& glb, std::span<const TextureFile> textures) : glb_(glb), textures_(textures) {}

  void add(const Material& given) {
    tinygltf::Material material = factors_of(given);
    material.name = given.name;
    tinygltf::PbrMetallicRoughness& surface = material.pbrMetallicRoughness;
    set(given.base_color_texture, surface.baseColorTexture);
    set(given.metallic_roughness_texture, surface.metallicRoughnessTexture);
    set(given.normal_texture, material.normalTexture);
    set(given.occlusion_texture, material.occlusionTexture);
    set(given.emissive_texture, material.emissiveTexture);
    material.normalTexture.scale = given.normal_scale;
    material.occlusionTexture.strength = given.occlusion_strength;
    glb_.model.materials.push_back(std::move(material));
  }

 private:
  template <class Info>
  void set(const TextureUse& use, Info& info) {
    if (use.texture >= textures_.size()) return;
    info.index = texture_of(use);
    info.texCoord = static_cast<int>(use.uv_set);
    if (use.place == TextureUse{}.place) return;
    info.extensions["KHR_texture_transform"] = transform_of(use);
    declare("KHR_texture_transform", false);
  }

  int texture_of(const TextureUse& use) {
    const auto [known, is_new] =
        numbers_.try_emplace({use.texture, use.wrap}, static_cast<int>(glb_.model.textures.size()));
    if (!is_new) return known->second;
    tinygltf::Sampler sampler;
    sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.wrapS = wrap_in_gltf(use.wrap[0]);
    sampler.wrapT = wrap_in_gltf(use.wrap[1]);
    glb_.model.samplers.push_back(sampler);
    tinygltf::Texture texture;
    texture.sampler = static_cast<int>(glb_.model.samplers.size()) - 1;
    const int image = image_of(use.texture);
    if (std::string_view(picture_format(textures_[use.texture].bytes)) == "webp") {
      texture.extensions["EXT_texture_webp"] =
          tinygltf::Value(tinygltf::Value::Object{{"source", tinygltf::Value(image)}});
      declare("EXT_texture_webp", true);
    } else {
      texture.source = image;
    }
    glb_.model.textures.push_back(std::move(texture));
    return known->second;
  }

  int image_of(std::uint32_t texture) {
    const auto [known, is_new] = images_.try_emplace(texture, static_cast<int>(glb_.model.images.size()));
    if (!is_new) return known->second;
    const TextureFile& file = textures_[texture];
    const std::string_view format = picture_format(file.bytes);
    tinygltf::Image image;
    image.name = file.name;
    image.mimeType = format == "jpg" ? "image/jpeg" : "image/" + std::string(format);
    image.bufferView = glb_.add_view(file.bytes.size(), 0);
    std::ranges::copy(file.bytes, glb_.view_bytes(image.bufferView));
    glb_.model.images.push_back(std::move(image));
    return known->second;
  }

  void declare(const char* extension, bool required) {
    for (std::vector<std::string>* const list :
         {&glb_.model.extensionsUsed, required ? &glb_.model.extensionsRequired : nullptr})
      if (list != nullptr && std::ranges::count(*list, extension) == 0) list->emplace_back(extension);
  }

  GlbModel& glb_;
  std::span<const TextureFile> textures_;
  std::map<std::pair<std::uint32_t, std::array<TextureWrap, 2>>, int> numbers_;
  std::map<std::uint32_t, int> images_;
};

}  // namespace

tinygltf::Material factors_of(const Material& factors) {
  tinygltf::Material material;
  material.doubleSided = true;
  material.alphaMode = name_in_gltf(factors.alpha_mode);
  if (factors.alpha_mode == AlphaMode::mask) material.alphaCutoff = factors.alpha_cutoff;
  material.emissiveFactor = in_unit_range(factors.emissive);
  tinygltf::PbrMetallicRoughness& surface = material.pbrMetallicRoughness;
  surface.baseColorFactor = in_unit_range(factors.base_color);
  surface.metallicFactor = std::clamp(factors.metallic, 0.f, 1.f);
  surface.roughnessFactor = std::clamp(factors.roughness, 0.f, 1.f);
  return material;
}

void add_materials(GlbModel& glb, std::span<const Material> materials,
                   std::span<const TextureFile> textures) {
  MaterialWriter writer(glb, textures);
  for (const Material& material : materials) writer.add(material);
}

}  // namespace sdm::io
