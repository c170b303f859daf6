#include <sdm/error.h>

#include <utility>

#include "core/memory.h"
#include "core/vec.h"
#include "io/read/formats.h"
#include "io/read/gltf_document.h"

namespace sdm {
namespace {

using nlohmann::json;

// x → linear · x + offset, the columns of the linear part one after the other.
struct Affine {
  std::array<Vec3, 3> linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 offset{};

  [[nodiscard]] Vec3 turn(const Vec3& x) const {
    return x[0] * linear[0] + x[1] * linear[1] + x[2] * linear[2];
  }
  [[nodiscard]] Vec3 operator()(const Vec3& x) const { return turn(x) + offset; }
  [[nodiscard]] Affine operator*(const Affine& inner) const {
    return {{turn(inner.linear[0]), turn(inner.linear[1]), turn(inner.linear[2])}, (*this)(inner.offset)};
  }
  [[nodiscard]] bool mirrors() const { return dot(cross(linear[0], linear[1]), linear[2]) < 0; }
};

// translation · rotation · scale, or a matrix of columns.
Affine node_transform(const json& node) {
  Affine t;
  if (node.contains("matrix")) {
    const auto m = node["matrix"].get<std::array<double, 16>>();
    for (int c = 0; c < 3; ++c) t.linear[c] = {m[4 * c], m[4 * c + 1], m[4 * c + 2]};
    t.offset = {m[12], m[13], m[14]};
    return t;
  }
  const auto [x, y, z, w] = node.value("rotation", std::array<double, 4>{0, 0, 0, 1});
  const auto scale = node.value("scale", Vec3{1, 1, 1});
  t.linear = {{{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
               {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
               {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}}};
  for (int c = 0; c < 3; ++c) t.linear[c] = scale[c] * t.linear[c];
  t.offset = node.value("translation", Vec3{});
  return t;
}

struct Instance {
  std::size_t mesh;
  Affine to_scene;
};

// The nodes at the top: of the default scene, else of the first, else all that are no one's child.
std::vector<std::size_t> roots(const GltfDocument& document) {
  const json& root = document.root();
  if (root.contains("scenes") && !root["scenes"].empty())
    return whole_numbers(document.item("scenes", whole_number(root, "scene", 0)), "nodes");
  const json nodes = root.value("nodes", json::array());
  std::vector<bool> is_child(nodes.size(), false);
  for (const json& node : nodes)
    for (const std::size_t child : whole_numbers(node, "children"))
      if (child < is_child.size()) is_child[child] = true;
  std::vector<std::size_t> result;
  for (std::size_t n = 0; n < is_child.size(); ++n)
    if (!is_child[n]) result.push_back(n);
  return result;
}

// All meshes with their places, in the order of the node tree. A node that is met twice would make a cycle or
// a tree that grows without bound: glTF forbids it.
std::vector<Instance> instances(const GltfDocument& document) {
  std::vector<Instance> result;
  std::vector<std::pair<std::size_t, Affine>> stack;
  const auto push = [&](const std::vector<std::size_t>& nodes, const Affine& to_scene) {
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) stack.emplace_back(*node, to_scene);
  };
  std::vector<bool> met(document.root().value("nodes", json::array()).size(), false);
  push(roots(document), {});
  while (!stack.empty()) {
    const auto [index, to_parent] = stack.back();
    stack.pop_back();
    const json& node = document.item("nodes", index);
    if (met[index]) throw Error("node " + std::to_string(index) + " has two parents, which glTF forbids");
    met[index] = true;
    const Affine to_scene = to_parent * node_transform(node);
    if (node.contains("mesh")) result.push_back({whole_number(node, "mesh"), to_scene});
    push(whole_numbers(node, "children"), to_scene);
  }
  return result;
}

enum Mode : std::size_t { kTriangles = 4, kStrip = 5, kFan = 6 };

// Points and lines have no surface.
bool has_triangles(const json& primitive) {
  const std::size_t mode = whole_number(primitive, "mode", kTriangles);
  return mode >= kTriangles && mode <= kFan && primitive.at("attributes").contains("POSITION");
}

// The places in the list of indices of the i-th triangle's corners.
std::array<std::size_t, 3> corner_places(std::size_t mode, std::size_t i) {
  if (mode == kStrip) return i % 2 == 0 ? std::array{i, i + 1, i + 2} : std::array{i + 1, i, i + 2};
  if (mode == kFan) return {0, i + 1, i + 2};
  return {3 * i, 3 * i + 1, 3 * i + 2};
}

void add_primitive(const GltfDocument& document, const json& primitive, const Affine& to_scene,
                   PolygonMesh& mesh) {
  const json& attributes = primitive.at("attributes");
  const GltfNumbers positions = document.numbers(whole_number(attributes, "POSITION"));
  if (positions.columns != 3) throw Error("the positions of a mesh are not vectors of three");
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
    // glTF's v runs down from the upper left.
    for (std::size_t v = 0; has_uvs && v < uvs.rows(); ++v)
      mesh.uvs.push_back({uvs.row(v)[0], 1 - uvs.row(v)[1]});
  }

  GltfNumbers indices{1, {}};
  if (primitive.contains("indices")) indices = document.numbers(whole_number(primitive, "indices"));
  const std::size_t count = primitive.contains("indices") ? indices.values.size() : positions.rows();
  const std::size_t mode = whole_number(primitive, "mode", kTriangles);
  const std::size_t triangles = mode == kTriangles ? count / 3 : count < 3 ? 0 : count - 2;
  for (std::size_t i = 0; i < triangles; ++i) {
    std::array<std::size_t, 3> places = corner_places(mode, i);
    if (to_scene.mirrors()) std::swap(places[1], places[2]);
    for (const std::size_t place : places) {
      const double index = primitive.contains("indices") ? indices.values[place] : static_cast<double>(place);
      if (!(index >= 0 && index < static_cast<double>(positions.rows())))
        throw Error("index out of range: a triangle refers to a vertex beyond the " +
                    std::to_string(positions.rows()) + " of its mesh");
      const auto v = static_cast<std::size_t>(index);
      mesh.corners.push_back(static_cast<std::uint32_t>(first_vertex + v));
      mesh.corner_uvs.push_back(has_uvs ? static_cast<std::uint32_t>(first_uv + v) : kNone);
    }
    mesh.end_polygon();
  }
}

// Many nodes may show one mesh: a small file can ask for a large scene.
void check_memory(const GltfDocument& document, const std::vector<Instance>& scene) {
  constexpr std::size_t bytes_per_item = 128;
  std::size_t items = 0;
  const auto add = [&](std::size_t count) {
    if (count >= kNone - items) throw Error("the scene has more than 2^32 vertices and corners of faces");
    items += count;
  };
  for (const Instance& instance : scene)
    for (const json& primitive : document.item("meshes", instance.mesh).at("primitives")) {
      if (!has_triangles(primitive)) continue;
      add(document.count(whole_number(primitive["attributes"], "POSITION")));
      if (primitive.contains("indices")) add(document.count(whole_number(primitive, "indices")));
    }
  require_memory(items * bytes_per_item, "the scene");
}

PolygonMesh read_scene(const GltfDocument& document) {
  const std::vector<Instance> scene = instances(document);
  check_memory(document, scene);
  PolygonMesh mesh;
  for (const Instance& instance : scene)
    for (const json& primitive : document.item("meshes", instance.mesh).at("primitives"))
      if (has_triangles(primitive)) add_primitive(document, primitive, instance.to_scene, mesh);
  return mesh;
}

}  // namespace

PolygonMesh read_gltf(std::string_view bytes, const std::filesystem::path& file) {
  try {
    return read_scene(GltfDocument(bytes, file.parent_path()));
  } catch (const json::exception& fault) {
    // The library's messages begin with a code in brackets.
    const std::string text = fault.what();
    throw Error("this is not valid glTF: " + text.substr(std::min(text.size(), text.find("] ") + 2)));
  }
}

}  // namespace sdm
