#include "io/mesh/gltf/gltf_materials.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/mesh/gltf/document/gltf_buffers.h"
#include "io/mesh/gltf/document/gltf_extensions.h"

namespace sdm::io {
namespace {

using nlohmann::json;

float number_of(const json& object, const char* name, float otherwise) {
  const auto value = object.find(name);
  if (value == object.end() || !value->is_number()) return otherwise;
  const auto number = value->get<float>();
  return std::isfinite(number) ? number : otherwise;
}

template <std::size_t N>
std::array<float, N> numbers_of(const json& object, const char* name, std::array<float, N> otherwise) {
  const auto list = object.find(name);
  if (list == object.end() || !list->is_array() || list->size() != N) return otherwise;
  for (std::size_t k = 0; k < N; ++k)
    if ((*list)[k].is_number() && std::isfinite((*list)[k].get<float>()))
      otherwise[k] = (*list)[k].get<float>();
  return otherwise;
}

AlphaMode alpha_mode_of(const json& material) {
  const auto mode = material.find("alphaMode");
  if (mode == material.end() || !mode->is_string() || *mode == "OPAQUE") return AlphaMode::opaque;
  return *mode == "MASK" ? AlphaMode::mask : AlphaMode::blend;
}

const json& member(const json& object, const char* name) {
  static const json kNothing = json::object();
  const auto found = object.find(name);
  return found != object.end() && found->is_object() ? *found : kNothing;
}

TextureWrap wrap_of(const json& sampler, const char* name) {
  switch (whole_number(sampler, name, 10497)) {
    case 33071:
      return TextureWrap::clamp;
    case 33648:
      return TextureWrap::mirror;
    default:
      return TextureWrap::repeat;
  }
}

// KHR_texture_transform: offset + rotation · scale, of coordinates whose v points down. In ours it points up:
// v' = 1 − v before and after.
std::array<std::array<double, 3>, 2> place_of(const json& transform) {
  const auto offset = numbers_of<2>(transform, "offset", {0, 0}),
             scale = numbers_of<2>(transform, "scale", {1, 1});
  const auto rotation = transform.find("rotation");
  const double angle = rotation != transform.end() && rotation->is_number() ? rotation->get<double>() : 0,
               c = std::cos(angle), s = std::sin(angle);
  const double uu = c * scale[0], uv = s * scale[1], vu = -s * scale[0], vv = c * scale[1];
  return {{{uu, -uv, offset[0] + uv}, {-vu, vv, 1 - offset[1] - vv}}};
}

class MaterialReader {
 public:
  MaterialReader(const GltfDocument& document, const std::filesystem::path& folder,
                 PolygonMaterials& materials)
      : document_(document), folder_(folder), materials_(materials) {}

  void read() {
    for (const json& item : list_of(document_.root(), "materials")) {
      Material& material = materials_.list.emplace_back();
      name_ = std::to_string(materials_.list.size() - 1);
      material.name = "material " + name_;
      if (const auto name = item.find("name"); name != item.end() && name->is_string())
        name_ = material.name = *name;
      const json& surface = member(item, "pbrMetallicRoughness");
      material.base_color = numbers_of<4>(surface, "baseColorFactor", {1, 1, 1, 1});
      material.metallic = number_of(surface, "metallicFactor", 1);
      material.roughness = number_of(surface, "roughnessFactor", 1);
      material.emissive = numbers_of<3>(item, "emissiveFactor", {0, 0, 0});
      material.alpha_mode = alpha_mode_of(item);
      material.alpha_cutoff = number_of(item, "alphaCutoff", 0.5f);
      material.normal_scale = number_of(member(item, "normalTexture"), "scale", 1);
      material.occlusion_strength = number_of(member(item, "occlusionTexture"), "strength", 1);
      material.base_color_texture = use(surface, "baseColorTexture");
      material.metallic_roughness_texture = use(surface, "metallicRoughnessTexture");
      material.normal_texture = use(item, "normalTexture");
      material.occlusion_texture = use(item, "occlusionTexture");
      material.emissive_texture = use(item, "emissiveTexture");
      const json* const glossy = gltf_extension(item, "KHR_materials_pbrSpecularGlossiness");
      if (glossy != nullptr && !item.contains("pbrMetallicRoughness")) read_glossy(*glossy, material);
    }
  }

 private:
  // The model before metals: of its two colours, that of light which is scattered is the base colour.
  void read_glossy(const json& surface, Material& material) {
    if (!surface.is_object()) return;
    material.base_color = numbers_of<4>(surface, "diffuseFactor", {1, 1, 1, 1});
    material.base_color_texture = use(surface, "diffuseTexture");
    material.metallic = 0;
    material.roughness = 1 - std::clamp(number_of(surface, "glossinessFactor", 1), 0.f, 1.f);
    const bool picture = surface.contains("specularGlossinessTexture");
    materials_.leave_out(
        picture ? "the picture of specular colour and glossiness" : "the specular colour", name_,
        "of KHR_materials_pbrSpecularGlossiness, the diffuse colour and the glossiness factor "
        "are read");
  }

  TextureUse use(const json& owner, const char* name) {
    const auto info = owner.find(name);
    if (info == owner.end()) return {};
    try {
      return use_of(*info);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& fault) {
      leave_out(name, fault.what());
    } catch (const json::exception&) {
      leave_out(name, "what the file says of it is not valid glTF");
    }
    return {};
  }
  void leave_out(const char* name, const std::string& fault) {
    materials_.leave_out(fmt::format("the {}", name), name_, fault);
  }

  TextureUse use_of(const json& info) {
    const json& texture = document_.item("textures", whole_number(info, "index"));
    TextureUse use;
    use.uv_set = static_cast<std::uint32_t>(std::min<std::size_t>(whole_number(info, "texCoord", 0), kNone));
    if (const json* const transform = gltf_extension(info, "KHR_texture_transform")) {
      use.place = place_of(*transform);
      use.uv_set = static_cast<std::uint32_t>(
          std::min<std::size_t>(whole_number(*transform, "texCoord", use.uv_set), kNone));
    }
    if (texture.contains("sampler")) {
      const json& sampler = document_.item("samplers", whole_number(texture, "sampler"));
      use.wrap = {wrap_of(sampler, "wrapS"), wrap_of(sampler, "wrapT")};
    }
    use.texture = picture(source_of(texture));
    return use;
  }

  // WebP stands beside a fallback, or alone.
  static std::size_t source_of(const json& texture) {
    if (const json* const webp = gltf_extension(texture, "EXT_texture_webp"))
      return whole_number(*webp, "source");
    if (texture.contains("source")) return whole_number(texture, "source");
    for (const char* extension : {"KHR_texture_basisu", "EXT_texture_avif", "MSFT_texture_dds"})
      if (gltf_extension(texture, extension) != nullptr)
        throw Error(fmt::format("its picture is compressed with {}, which is not supported", extension));
    throw Error("it has no picture");
  }

  std::uint32_t picture(std::size_t image) {
    if (const auto known = pictures_.find(image); known != pictures_.end()) return known->second;
    const json& item = document_.item("images", image);
    TextureFile file{.name = fmt::format("image {}", image), .bytes = {}};
    if (const auto name = item.find("name"); name != item.end() && name->is_string()) file.name = *name;
    if (const auto uri = item.find("uri"); uri == item.end()) {
      const std::size_t view = whole_number(item, "bufferView");
      if (const auto known = of_view_.find(view); known != of_view_.end())
        return pictures_[image] = known->second;
      of_view_[view] = static_cast<std::uint32_t>(materials_.textures.size());
      const std::string_view bytes = document_.view(view);
      document_.charge(bytes.size(), "the pictures");
      file.bytes.assign(bytes.begin(), bytes.end());
    } else if (const std::string& text = text_of(*uri, "the URI of a picture"); is_data_uri(text)) {
      const FileBytes bytes = decode_data_uri(text);
      document_.charge(bytes.view().size(), "the pictures");
      file.bytes.assign(bytes.view().begin(), bytes.view().end());
    } else {
      return pictures_[image] = materials_.texture_in_file(folder_, decode_uri(text));
    }
    materials_.textures.push_back(std::move(file));
    return pictures_[image] = static_cast<std::uint32_t>(materials_.textures.size() - 1);
  }

  const GltfDocument& document_;
  const std::filesystem::path& folder_;
  PolygonMaterials& materials_;
  std::string name_;                               // of the material that is read, or its number
  std::map<std::size_t, std::uint32_t> pictures_;  // the texture of each image
  std::map<std::size_t, std::uint32_t> of_view_;   // of each bufferView that images name
};

}  // namespace

void read_gltf_materials(const GltfDocument& document, const std::filesystem::path& folder,
                         PolygonMaterials& materials, std::vector<std::string>& notes) {
  MaterialReader(document, folder, materials).read();
  materials.move_notes(notes);
}

}  // namespace sdm::io
