#include "io/mesh/gltf/gltf_attributes.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "io/mesh/gltf/document/gltf_rows.h"

namespace sdm::io {
namespace {

using nlohmann::json;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// The name under which an attribute is known; empty for those that are left out.
std::string known_name(const std::string& name) {
  if (name == "NORMAL") return "normal";
  if (name == "COLOR_0") return "color";
  if (name.starts_with("TEXCOORD_") && name != "TEXCOORD_0") return "uv" + name.substr(9);
  if (name.starts_with("COLOR_")) return "color" + name.substr(6);
  return name.starts_with('_') ? name : "";
}

// Normals move by the matrix of cofactors, which is the inverse transpose but for a factor.
Vec3 moved_normal(const GltfTransform& t, const Vec3& n) {
  const auto& [x, y, z] = t.linear;
  const Vec3 moved = n[0] * cross(y, z) + n[1] * cross(z, x) + n[2] * cross(x, y);
  return (t.determinant() < 0 ? -1.0 : 1.0) * normalized(moved);
}

}  // namespace

void GltfAttributes::add(const GltfDocument& document, const json& attributes, const GltfPlacement& placement,
                         std::size_t first_vertex, std::size_t vertices, bool morphed) {
  for (const auto& [key, accessor] : attributes.items()) {
    const std::string name = known_name(key);
    if (name.empty() || (name == "normal" && morphed)) continue;
    const GltfRows rows(document, whole_number(attributes, key.c_str()));
    if (rows.rows() != vertices)
      throw Error(fmt::format("the attribute {} and the mesh differ in their number of vertices", key));
    const bool is_color = name.starts_with("color"), is_uv = name.starts_with("uv");
    if ((name == "normal" && rows.columns() != 3) || (is_uv && rows.columns() != 2) ||
        (is_color && rows.columns() < 3))
      throw Error(fmt::format("the attribute {} has {} components", key, rows.columns()));
    const std::size_t components = is_color ? 4 : rows.columns();
    document.charge(vertices * components * sizeof(float), "the attributes of vertices");
    std::vector<float>* const values = array(name, components, first_vertex);
    if (values == nullptr) continue;
    for (std::size_t v = 0; v < vertices; ++v) {
      if (name == "normal") {
        for (const double x : moved_normal(placement[v], rows.vec3(v)))
          values->push_back(static_cast<float>(x));
        continue;
      }
      for (std::size_t k = 0; k < components; ++k) {
        const double number = k < rows.columns() ? rows.number(v, k) : 1;              // opaque
        values->push_back(static_cast<float>(is_uv && k == 1 ? 1 - number : number));  // v points down
      }
    }
  }
}

std::vector<float>* GltfAttributes::array(const std::string& name, std::size_t components,
                                          std::size_t first_vertex) {
  auto found = std::ranges::find(arrays_, name, &PolygonAttribute::name);
  if (found == arrays_.end()) {
    arrays_.push_back(
        {.name = name, .components = components, .domain = PolygonDomain::vertex, .values = {}, .rows = {}});
    found = arrays_.end() - 1;
  }
  if (found->components != components) return nullptr;
  found->values.resize(first_vertex * components, kNaN);
  return &found->values;
}

std::vector<PolygonAttribute> GltfAttributes::take(std::size_t vertices) {
  for (PolygonAttribute& attribute : arrays_) attribute.values.resize(vertices * attribute.components, kNaN);
  return std::exchange(arrays_, {});
}

}  // namespace sdm::io
