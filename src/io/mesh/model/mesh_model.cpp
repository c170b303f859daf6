#include "io/mesh/model/mesh_model.h"

#include <sdm/error.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "io/mesh/model/glb_model.h"
#include "io/mesh/model/gltf_material.h"
#include "io/mesh/split_vertices.h"

namespace sdm::io {
namespace {

/// An attribute of the file, and its name in glTF.
struct Written {
  const MeshAttribute* attribute;
  std::string name;
  float without;  ///< in place of values that the file does not have
};

// glTF has them one after the other: a set is kept if all before it are there.
std::vector<Written> written_attributes(const Mesh& mesh, std::span<const MeshAttribute> attributes) {
  std::vector<Written> result;
  if (const MeshAttribute* const normals = find_attribute(attributes, "normal", 3, 3);
      normals != nullptr && std::ranges::all_of(*normals->rows, [](const Triangle& t) {
        return t[0] != kNone && t[1] != kNone && t[2] != kNone;
      }))
    result.push_back({normals, "NORMAL", 0});
  if (const MeshAttribute* const colors = find_attribute(attributes, "color", 3, 4))
    result.push_back({colors, "COLOR_0", 1});
  for (std::size_t set = mesh.corner_uvs.empty() ? 0 : 1;; ++set) {
    const MeshAttribute* const uvs = find_attribute(attributes, "uv" + std::to_string(set), 2, 2);
    if (uvs == nullptr) return result;
    result.push_back({uvs, "TEXCOORD_" + std::to_string(set), 0});
  }
}

class ModelWriter {
 public:
  ModelWriter(const Mesh& mesh, const MeshExtras& extras)
      : mesh_(mesh),
        extras_(extras),
        uvs_(uv_rows(mesh)),
        attributes_(written_attributes(mesh, extras.attributes)) {
    std::vector<CornerRows> arrays;
    if (!uvs_.of.empty()) arrays.push_back({&uvs_.of});
    for (const Written& written : attributes_) arrays.push_back({written.attribute->rows.get()});
    vertices_ = split_vertices(mesh, arrays);
  }

  void write(std::ostream& out) {
    add_vertices();
    add_faces();
    add_materials(glb_, extras_.materials, extras_.textures);
    if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&glb_.model, out, false, true))
      throw Error("the glTF model could not be written");
  }

 private:
  template <class Element, class Fill>
  int add_column(const std::string& name, int type, const Fill& fill) {
    return accessors_[name] =
               glb_.add_accessor<Element>(vertices_.vertex.size(), type, TINYGLTF_COMPONENT_TYPE_FLOAT,
                                          TINYGLTF_TARGET_ARRAY_BUFFER, fill);
  }

  void add_vertices() {
    const auto position = [&](std::size_t i, Vec3f& p) {
      for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<float>(mesh_.positions[vertices_.vertex[i]][k]);
    };
    const int positions = add_column<Vec3f>("POSITION", TINYGLTF_TYPE_VEC3, position);
    Vec3f lo, hi, p;
    lo.fill(std::numeric_limits<float>::infinity());
    hi.fill(-std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < vertices_.vertex.size(); ++i) {
      position(i, p);
      for (std::size_t k = 0; k < 3; ++k) {
        lo[k] = std::min(lo[k], p[k]);
        hi[k] = std::max(hi[k], p[k]);
      }
    }
    auto& accessor = glb_.model.accessors[static_cast<std::size_t>(positions)];
    accessor.minValues.assign(lo.begin(), lo.end());
    accessor.maxValues.assign(hi.begin(), hi.end());
    if (!uvs_.of.empty())  // v points down
      add_column<std::array<float, 2>>("TEXCOORD_0", TINYGLTF_TYPE_VEC2,
                                       [&](std::size_t i, std::array<float, 2>& uv) {
                                         const std::uint32_t row = vertices_.rows[0][i];
                                         const Vec2 at = row == kNone ? Vec2{} : uvs_.uvs[row];
                                         uv = {static_cast<float>(at[0]), static_cast<float>(1 - at[1])};
                                       });
    for (std::size_t a = 0; a < attributes_.size(); ++a) add_attribute(a);
  }

  void add_attribute(std::size_t a) {
    const Written& written = attributes_[a];
    const std::vector<std::uint32_t>& rows = vertices_.rows[a + (uvs_.of.empty() ? 0 : 1)];
    const auto add = [&]<std::size_t N>(int type, std::array<float, N>) {
      add_column<std::array<float, N>>(written.name, type, [&](std::size_t i, std::array<float, N>& value) {
        value.fill(written.without);
        if (rows[i] != kNone) std::copy_n(&written.attribute->values[N * rows[i]], N, value.begin());
        if (written.name.starts_with("TEXCOORD")) value[1] = 1 - value[1];
        if (written.name.starts_with("COLOR"))
          for (float& x : value) x = std::clamp(x, 0.f, 1.f);
      });
    };
    if (written.attribute->components == 2) add(TINYGLTF_TYPE_VEC2, std::array<float, 2>{});
    if (written.attribute->components == 3) add(TINYGLTF_TYPE_VEC3, std::array<float, 3>{});
    if (written.attribute->components == 4) add(TINYGLTF_TYPE_VEC4, std::array<float, 4>{});
  }

  void add_faces() {
    const auto objects = std::ranges::find(extras_.names, "object", &FaceNames::kind);
    const bool has_objects = objects != extras_.names.end();
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Triangle>> parts;  // of object and material
    for (std::size_t f = 0; f < vertices_.triangles.size(); ++f)
      parts[{has_objects ? objects->of_face[f] : kNone,
             extras_.face_materials.empty() ? kNone : extras_.face_materials[f]}]
          .push_back(vertices_.triangles[f]);
    std::vector<tinygltf::Node> nodes;
    std::optional<std::uint32_t> last;
    for (const auto& [of, triangles] : parts) {
      const auto [object, material] = of;
      if (last != object) {
        last = object;
        tinygltf::Node& node = nodes.emplace_back();
        node.mesh = static_cast<int>(glb_.model.meshes.size());
        tinygltf::Mesh& of_model = glb_.model.meshes.emplace_back();
        if (object != kNone) node.name = of_model.name = objects->names[object];
      }
      tinygltf::Primitive primitive;
      primitive.mode = TINYGLTF_MODE_TRIANGLES;
      primitive.attributes = accessors_;
      if (material != kNone) primitive.material = static_cast<int>(material);
      primitive.indices = glb_.add_accessor<Triangle>(
          triangles.size(), TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
          TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, [&](std::size_t i, Triangle& t) { t = triangles[i]; });
      glb_.model.meshes.back().primitives.push_back(std::move(primitive));
    }
    glb_.add_scene(nodes);
  }

  const Mesh& mesh_;
  const MeshExtras& extras_;
  UvRows uvs_;
  std::vector<Written> attributes_;
  SplitVertices vertices_;
  GlbModel glb_;
  std::map<std::string, int> accessors_;
};

}  // namespace

void write_model(std::ostream& out, const Mesh& mesh, const MeshExtras& extras) {
  ModelWriter(mesh, extras).write(out);
}

}  // namespace sdm::io
