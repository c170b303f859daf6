#include <fmt/format.h>
#include <sdm/error.h>

#include <utility>

#include "core/memory.h"
#include "io/read/formats.h"
#include "io/read/gltf/gltf_scene.h"

namespace sdm::io {
namespace {

using nlohmann::json;

// Returns the positions of the i-th triangle's corners in the list of indices.
std::array<std::size_t, 3> corner_places(std::size_t mode, std::size_t i) {
  if (mode == kStrip) return i % 2 == 0 ? std::array{i, i + 1, i + 2} : std::array{i + 1, i, i + 2};
  if (mode == kFan) return {0, i + 1, i + 2};
  return {3 * i, 3 * i + 1, 3 * i + 2};
}

void add_primitive(const GltfDocument& document, const json& primitive, const GltfTransform& to_scene,
                   PolygonMesh& mesh) {
  const json& attributes = primitive.at("attributes");
  const GltfNumbers positions = document.numbers(whole_number(attributes, "POSITION"));
  if (positions.columns != 3) throw Error("the positions of a mesh are not of type VEC3");
  const std::size_t first_vertex = mesh.positions.size();
  for (std::size_t v = 0; v < positions.rows(); ++v) {
    const double* p = positions.row(v);
    mesh.positions.push_back(to_scene({p[0], p[1], p[2]}));
  }

  const std::size_t first_uv = mesh.uvs.size();
  bool has_uvs = attributes.contains("TEXCOORD_0");
  if (has_uvs) {
    const GltfNumbers uvs = document.numbers(whole_number(attributes, "TEXCOORD_0"));
    has_uvs = uvs.columns == 2 && uvs.rows() == positions.rows();
    // In glTF, v points down.
    for (std::size_t v = 0; has_uvs && v < uvs.rows(); ++v)
      mesh.uvs.push_back({uvs.row(v)[0], 1 - uvs.row(v)[1]});
  }

  GltfNumbers indices{1, {}};
  if (primitive.contains("indices")) indices = document.numbers(whole_number(primitive, "indices"));
  const std::size_t count = primitive.contains("indices") ? indices.values.size() : positions.rows();
  const std::size_t mode = gltf_mode(primitive);
  const std::size_t triangles = mode == kTriangles ? count / 3 : count < 3 ? 0 : count - 2;
  for (std::size_t i = 0; i < triangles; ++i) {
    std::array<std::size_t, 3> places = corner_places(mode, i);
    if (to_scene.mirrors()) std::swap(places[1], places[2]);
    for (const std::size_t place : places) {
      const double index = primitive.contains("indices") ? indices.values[place] : static_cast<double>(place);
      if (!(index >= 0 && index < static_cast<double>(positions.rows())))
        throw Error(
            fmt::format("index out of range: a triangle refers to vertex {} of {}", index, positions.rows()));
      const auto v = static_cast<std::size_t>(index);
      mesh.corners.push_back(static_cast<std::uint32_t>(first_vertex + v));
      mesh.corner_uvs.push_back(has_uvs ? static_cast<std::uint32_t>(first_uv + v) : kNone);
    }
    mesh.end_polygon();
  }
}

// Many nodes may share a mesh, so a small file can expand to a large scene.
void check_memory(const GltfDocument& document, const std::vector<GltfInstance>& scene) {
  constexpr std::size_t bytes_per_item = 128;
  std::size_t items = 0;
  const auto add = [&](std::size_t count) {
    if (count >= kNone - items) throw Error("the scene has more than 2^32 vertices and corners of faces");
    items += count;
  };
  for (const GltfInstance& instance : scene)
    for (const json& primitive : document.item("meshes", instance.mesh).at("primitives")) {
      if (!has_triangles(primitive)) continue;
      add(document.count(whole_number(primitive["attributes"], "POSITION")));
      if (primitive.contains("indices")) add(document.count(whole_number(primitive, "indices")));
    }
  require_memory(items * bytes_per_item, "the scene");
}

// Names are optional.
std::string name_of(const json& item, const std::string& otherwise) {
  const auto name = item.find("name");
  return name != item.end() && name->is_string() ? name->get<std::string>() : otherwise;
}

// The name of a mesh defaults to that of its node, the name of a material to its number.
void begin_names(const GltfDocument& document, const GltfInstance& instance, const json& primitive,
                 PolygonMesh& mesh) {
  const std::string node = name_of(document.item("nodes", instance.node), "");
  mesh.objects.begin(mesh.ends.size(), name_of(document.item("meshes", instance.mesh), node));
  std::string material;
  if (const auto index = primitive.find("material");
      index != primitive.end() && index->is_number_unsigned()) {
    const auto materials = document.root().find("materials");
    const std::string number = fmt::format("material {}", index->get<std::size_t>());
    const bool exists = materials != document.root().end() && index->get<std::size_t>() < materials->size();
    material = exists ? name_of(materials->at(index->get<std::size_t>()), number) : number;
  }
  mesh.materials.begin(mesh.ends.size(), material);
}

}  // namespace

PolygonMesh read_gltf_scene(const GltfDocument& document) {
  const std::vector<GltfInstance> scene = gltf_instances(document);
  check_memory(document, scene);
  PolygonMesh mesh;
  for (const GltfInstance& instance : scene)
    for (const json& primitive : document.item("meshes", instance.mesh).at("primitives"))
      if (has_triangles(primitive)) {
        begin_names(document, instance, primitive, mesh);
        add_primitive(document, primitive, instance.to_scene, mesh);
      }
  return mesh;
}

PolygonMesh read_gltf(std::string_view bytes, const std::filesystem::path& file) {
  try {
    return read_gltf_scene(GltfDocument(bytes, file.parent_path()));
  } catch (const json::exception& fault) {
    throw_gltf_fault(fault);
  }
}

}  // namespace sdm::io
