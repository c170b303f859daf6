#include "io/mesh/gltf/gltf_instances.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <cstdint>

#include "io/mesh/gltf/document/gltf_extensions.h"
#include "io/mesh/gltf/document/gltf_rows.h"
#include "io/mesh/gltf/gltf_nodes.h"

namespace sdm::io {
namespace {

using nlohmann::json;

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

// The transforms of the copies of a node's mesh, relative to the node.
class InstanceTransforms {
 public:
  InstanceTransforms(const GltfDocument& document, const json& extension) {
    const json& attributes = extension.at("attributes");
    translations_ = rows(document, attributes, "TRANSLATION", 3);
    rotations_ = rows(document, attributes, "ROTATION", 4);
    scales_ = rows(document, attributes, "SCALE", 3);
    if (!count_) throw Error(fmt::format("{} has no TRANSLATION, ROTATION or SCALE", kInstancing));
  }

  [[nodiscard]] std::size_t count() const { return *count_; }
  [[nodiscard]] GltfTransform operator()(std::size_t i) const {
    std::array<double, 4> rotation{0, 0, 0, 1};
    for (std::size_t k = 0; rotations_ && k < 4; ++k) rotation[k] = rotations_->number(i, k);
    return gltf_transform(translations_ ? translations_->vec3(i) : Vec3{}, rotation,
                          scales_ ? scales_->vec3(i) : Vec3{1, 1, 1});
  }

 private:
  std::optional<GltfRows> rows(const GltfDocument& document, const json& attributes, const char* name,
                               std::size_t columns) {
    if (!attributes.contains(name)) return {};
    const GltfRows rows(document, whole_number(attributes, name));
    if (rows.columns() != columns)
      throw Error(fmt::format("{} of {} is not of type VEC{}", name, kInstancing, columns));
    if (count_ && *count_ != rows.rows())
      throw Error(fmt::format("the attributes of {} differ in their number of instances", kInstancing));
    count_ = rows.rows();
    return rows;
  }

  std::optional<GltfRows> translations_, rotations_, scales_;
  std::optional<std::size_t> count_;
};

}  // namespace

std::vector<GltfInstance> gltf_instances(const GltfDocument& document) {
  std::vector<GltfInstance> result;
  visit_gltf_nodes(
      document, gltf_scene_roots(document), [&](std::size_t index, const GltfTransform& to_scene) {
        const json& node = document.item("nodes", index);
        if (!node.contains("mesh")) return;
        GltfInstance instance{index, whole_number(node, "mesh"), to_scene};
        if (node.contains("skin")) instance.skin = whole_number(node, "skin");
        const json* instancing = gltf_extension(node, kInstancing);
        if (instancing == nullptr) {
          document.charge(sizeof(GltfInstance), "the scene");
          result.push_back(instance);
          return;
        }
        if (instance.skin)
          throw Error(
              fmt::format("node {} has both a skin and {}, which glTF does not define", index, kInstancing));
        const InstanceTransforms transforms(document, *instancing);
        if (transforms.count() > UINT32_MAX)
          throw Error(fmt::format("node {} has more than 2^32 instances", index));
        document.charge(transforms.count() * sizeof(GltfInstance), "the instances of a mesh");
        for (std::size_t i = 0; i < transforms.count(); ++i) {
          instance.to_node = transforms(i);
          instance.to_scene = to_scene * instance.to_node;
          result.push_back(instance);
        }
      });
  return result;
}

}  // namespace sdm::io
