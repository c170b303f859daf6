#include "io/mesh/gltf/gltf_scene.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "io/mesh/gltf/document/gltf_extensions.h"
#include "io/mesh/gltf/document/gltf_rows.h"
#include "io/mesh/gltf/gltf_attributes.h"
#include "io/mesh/gltf/gltf_morph.h"
#include "io/mesh/gltf/gltf_skin.h"

namespace sdm::io {
namespace {

using nlohmann::json;

enum Mode : std::size_t { kTriangles = 4, kStrip = 5, kFan = 6 };

std::size_t mode_of(const json& primitive) {
  return whole_number(primitive, "mode", kTriangles);
}

// Returns the positions of the i-th triangle's corners in the list of indices.
std::array<std::size_t, 3> corner_places(std::size_t mode, std::size_t i) {
  if (mode == kStrip) return i % 2 == 0 ? std::array{i, i + 1, i + 2} : std::array{i + 1, i, i + 2};
  if (mode == kFan) return {0, i + 1, i + 2};
  return {3 * i, 3 * i + 1, 3 * i + 2};
}

void add_positions(const GltfDocument& document, const json& primitive, const GltfPlacement& placement,
                   const std::vector<double>& weights, PolygonMesh& mesh) {
  const GltfPositions positions(document, primitive, weights);
  for (std::size_t v = 0; v < positions.size(); ++v) mesh.positions.push_back(placement[v](positions[v]));
}

// Returns whether the primitive has one for each of its vertices.
bool add_uvs(const GltfDocument& document, const json& attributes, std::size_t vertices, PolygonMesh& mesh) {
  if (!attributes.contains("TEXCOORD_0")) return false;
  const GltfRows uvs(document, whole_number(attributes, "TEXCOORD_0"));
  if (uvs.columns() != 2 || uvs.rows() != vertices) return false;
  // glTF's v points down.
  for (std::size_t v = 0; v < vertices; ++v) mesh.uvs.push_back({uvs.number(v, 0), 1 - uvs.number(v, 1)});
  return true;
}

void add_primitive(const GltfDocument& document, const json& primitive, const GltfPlacement& placement,
                   const std::vector<double>& weights, PolygonMesh& mesh) {
  const std::size_t first_vertex = mesh.positions.size(), first_uv = mesh.uvs.size();
  add_positions(document, primitive, placement, weights, mesh);
  const std::size_t vertices = mesh.positions.size() - first_vertex;
  const bool has_uvs = add_uvs(document, primitive.at("attributes"), vertices, mesh);

  std::optional<GltfRows> indices;
  if (primitive.contains("indices")) indices.emplace(document, whole_number(primitive, "indices"));
  const std::size_t count = indices ? indices->rows() : vertices, mode = mode_of(primitive);
  const std::size_t triangles = mode == kTriangles ? count / 3 : count < 3 ? 0 : count - 2;
  for (std::size_t i = 0; i < triangles; ++i) {
    std::array<std::size_t, 3> places = corner_places(mode, i);
    if (placement.mirrors()) std::swap(places[1], places[2]);
    for (const std::size_t place : places) {
      const double index = indices ? indices->number(place) : static_cast<double>(place);
      if (!(index >= 0 && index < static_cast<double>(vertices)))
        throw Error(fmt::format("index out of range: a triangle refers to vertex {} of {}", index, vertices));
      const auto v = static_cast<std::size_t>(index);
      mesh.corners.push_back(static_cast<std::uint32_t>(first_vertex + v));
      mesh.corner_uvs.push_back(has_uvs ? static_cast<std::uint32_t>(first_uv + v) : kNone);
    }
    mesh.end_polygon();
  }
}

// Counts what takes memory or time for each instance of a mesh.
class SceneSize {
 public:
  void add(std::size_t count) {
    if (count >= kNone - items_) throw Error("the scene has more than 2^32 vertices and corners of faces");
    items_ += count;
  }
  [[nodiscard]] std::size_t items() const { return items_; }

 private:
  std::size_t items_ = 0;
};

std::size_t mesh_size(const GltfDocument& document, const GltfInstance& instance,
                      const std::vector<double>& weights) {
  SceneSize size;
  for (const json& primitive : list_of(document.item("meshes", instance.mesh), "primitives")) {
    size.add(1 + weights.size());
    if (!has_triangles(document, primitive)) continue;
    const json& attributes = primitive.at("attributes");
    const std::size_t vertices = document.count(whole_number(attributes, "POSITION"));
    const std::size_t corners =
        primitive.contains("indices") ? document.count(whole_number(primitive, "indices")) : vertices;
    size.add(vertices);
    for (int k = 0; k < (mode_of(primitive) == kTriangles ? 1 : 3); ++k) size.add(corners);
    for (const double weight : weights)
      if (weight != 0) size.add(vertices);
  }
  return size.items();
}

// Many nodes may share a mesh, and many primitives an accessor, so a small file can expand to a large scene.
void check_memory(const GltfDocument& document, const std::vector<GltfInstance>& instances,
                  const std::set<std::size_t>& unmorphed) {
  constexpr std::size_t bytes_per_item = 128;
  SceneSize size;
  std::size_t node = kNone, size_of_node = 0;  // the instances of a node follow each other
  for (const GltfInstance& instance : instances) {
    if (instance.node != node) {
      node = instance.node;
      size_of_node =
          mesh_size(document, instance,
                    unmorphed.contains(node) ? std::vector<double>() : gltf_weights(document, instance));
    }
    size.add(size_of_node);
    document.charge(size_of_node * bytes_per_item, "the scene");
  }
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
  std::uint32_t index = kNone;
  if (const auto number = primitive.find("material");
      number != primitive.end() && number->is_number_unsigned()) {
    const json& materials = list_of(document.root(), "materials");
    const auto i = number->get<std::size_t>();
    const std::string otherwise = fmt::format("material {}", i);
    material = i < materials.size() ? name_of(materials[i], otherwise) : otherwise;
    if (i < materials.size()) index = static_cast<std::uint32_t>(i);
  }
  mesh.materials.begin(mesh.ends.size(), material);
  mesh.surfaces.runs.push_back({static_cast<std::uint32_t>(mesh.ends.size()), index});
}

// Positions and indices without a place in the file.
bool is_without_data(const GltfDocument& document, const json& primitive) {
  const auto is_empty = [&](const json& object, const char* name) {
    if (!object.contains(name)) return false;
    const json& accessor = document.item("accessors", whole_number(object, name));
    return !accessor.contains("bufferView") && !accessor.contains("sparse");
  };
  return is_empty(primitive.at("attributes"), "POSITION") || is_empty(primitive, "indices");
}

}  // namespace

bool has_triangles(const GltfDocument& document, const json& primitive) {
  const std::size_t mode = mode_of(primitive);
  if (mode < kTriangles || mode > kFan || !primitive.at("attributes").contains("POSITION")) return false;
  if (const std::string_view extension = gltf_compression(primitive);
      !extension.empty() && is_without_data(document, primitive))
    refuse_compressed(extension);
  return true;
}

PolygonMesh read_gltf_scene(const GltfDocument& document, const std::vector<GltfInstance>& instances,
                            const std::set<std::size_t>& unmorphed, bool attributes, const GltfPose* pose) {
  check_memory(document, instances, unmorphed);
  GltfSkins skins(document, pose);
  PolygonMesh mesh;
  GltfAttributes of_vertices;
  for (const GltfInstance& instance : instances) {
    const std::vector<double> weights =
        unmorphed.contains(instance.node) ? std::vector<double>() : gltf_weights(document, instance);
    for (const json& primitive : list_of(document.item("meshes", instance.mesh), "primitives"))
      if (has_triangles(document, primitive)) {
        begin_names(document, instance, primitive, mesh);
        const GltfPlacement placement = skins.placement(instance, primitive);
        const std::size_t first_vertex = mesh.positions.size();
        add_primitive(document, primitive, placement, weights, mesh);
        if (attributes)
          of_vertices.add(document, primitive.at("attributes"), placement, first_vertex,
                          mesh.positions.size() - first_vertex,
                          std::ranges::any_of(weights, [](double w) { return w != 0; }));
      }
  }
  mesh.attributes = of_vertices.take(mesh.positions.size());
  return mesh;
}

}  // namespace sdm::io
