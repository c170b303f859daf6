#include "io/mesh/gltf/document/gltf_extensions.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "core/excerpt.h"
#include "io/mesh/gltf/document/gltf_document.h"

namespace sdm::io {
namespace {

using nlohmann::json;

constexpr const char* kCompressions[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                         "KHR_meshopt_compression"};

constexpr std::string_view kSupported[] = {
    // Applied.
    "EXT_mesh_gpu_instancing", "KHR_mesh_quantization",
    // Textures and lights; where texture coordinates lie in an image does not change them.
    "KHR_texture_transform", "KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds",
    "KHR_lights_punctual", "EXT_lights_image_based", "EXT_lights_ies",
    // More about the same triangles: solids, polygons, edges, identifiers.
    "EXT_mesh_manifold", "FB_ngon_encoding", "CESIUM_primitive_outline", "EXT_mesh_features",
    "EXT_instance_features", "EXT_structural_metadata", "KHR_xmp_json_ld",
    // Where animations write to; those that change more than weights are refused.
    "KHR_animation_pointer"};

bool is_supported(std::string_view extension) {
  return std::ranges::count(kSupported, extension) > 0 || extension.starts_with("KHR_materials_");
}

}  // namespace

void check_required_extensions(const json& root) {
  for (const json& item : list_of(root, "extensionsRequired")) {
    const std::string& extension = text_of(item, "a required extension");
    if (std::ranges::count(kCompressions, extension) > 0) refuse_compressed(extension);
    if (!is_supported(extension))
      throw Error(
          fmt::format("requires the extension {}, which is not supported; save it without this extension",
                      excerpt(extension)));
  }
}

std::string_view gltf_compression(const json& object) {
  for (const char* name : kCompressions)
    if (gltf_extension(object, name) != nullptr) return name;
  return {};
}

void refuse_compressed(std::string_view extension) {
  throw Error(
      fmt::format("is compressed with {}, which is not supported; save it without compression", extension));
}

const json* gltf_extension(const json& object, const char* name) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end()) return nullptr;
  const auto extension = extensions->find(name);
  return extension == extensions->end() ? nullptr : &*extension;
}

}  // namespace sdm::io
