#include "io/mesh/model/drawn_surface.h"

#include <algorithm>
#include <array>
#include <limits>

namespace sdm::io {

tinygltf::Primitive primitive_of(GlbModel& glb, const DrawnSurface& drawn, const ModelVertices& vertices) {
  const std::size_t count = vertices.place.size();
  const auto vertex = [&](std::size_t i) { return drawn.normals.vertex[vertices.normal[i]]; };
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = 0;
  primitive.indices = glb.add_accessor<Triangle>(
      vertices.triangles.size(), TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
      TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, [&](std::size_t i, Triangle& t) { t = vertices.triangles[i]; });
  const auto add_attribute = [&]<class Element>(const char* name, int type, Element /*kind*/,
                                                const auto& fill) {
    return primitive.attributes[name] = glb.add_accessor<Element>(count, type, TINYGLTF_COMPONENT_TYPE_FLOAT,
                                                                  TINYGLTF_TARGET_ARRAY_BUFFER, fill);
  };
  const auto position = [&](std::size_t i, Vec3f& q) {
    const Vec3 p = drawn.mesh.positions[vertex(i)] - drawn.place.origin;
    for (int k = 0; k < 3; ++k) q[k] = static_cast<float>(p[k]);
  };
  auto& accessor = glb.model.accessors[add_attribute("POSITION", TINYGLTF_TYPE_VEC3, Vec3f{}, position)];
  Vec3f lo, hi, q;
  lo.fill(std::numeric_limits<float>::infinity());
  hi.fill(-std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < count; ++i) {
    position(i, q);
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], q[k]);
      hi[k] = std::max(hi[k], q[k]);
    }
  }
  accessor.minValues.assign(lo.begin(), lo.end());
  accessor.maxValues.assign(hi.begin(), hi.end());
  add_attribute("NORMAL", TINYGLTF_TYPE_VEC3, Vec3f{},
                [&](std::size_t i, Vec3f& n) { n = drawn.normals.normals[vertices.normal[i]]; });
  add_attribute("TEXCOORD_0", TINYGLTF_TYPE_VEC2, std::array<float, 2>{},  // in [0, 1], v down
                [&](std::size_t i, std::array<float, 2>& uv) {
                  for (int k = 0; k < 2; ++k)
                    uv[k] = static_cast<float>(std::clamp(vertices.place[i][k] / drawn.extent[k], 0.0, 1.0));
                });
  if (drawn.tangents != nullptr)
    add_attribute("TANGENT", TINYGLTF_TYPE_VEC4, std::array<float, 4>{},
                  [&](std::size_t i, std::array<float, 4>& tangent) {
                    std::copy_n(&drawn.tangents->values[4 * std::size_t{vertices.tangent[i]}], 4,
                                tangent.begin());
                  });
  return primitive;
}

std::size_t bytes_of(const ModelVertices& vertices) {
  const std::size_t floats = 3 + 3 + 2 + (vertices.tangent.empty() ? 0 : 4);
  return vertices.triangles.size() * sizeof(Triangle) + vertices.place.size() * floats * sizeof(float);
}

int add_png(GlbModel& glb, std::span<const char> png, int smaller) {
  tinygltf::Model& model = glb.model;
  tinygltf::Image image;
  image.bufferView = glb.add_view(png.size(), 0);
  std::ranges::copy(png, glb.view_bytes(image.bufferView));
  image.mimeType = "image/png";
  model.images.push_back(image);
  if (model.samplers.empty()) {
    tinygltf::Sampler sampler;
    sampler.minFilter = smaller;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.wrapS = sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    model.samplers.push_back(sampler);
  }
  tinygltf::Texture texture;
  texture.sampler = 0;
  texture.source = static_cast<int>(model.images.size()) - 1;
  model.textures.push_back(texture);
  return static_cast<int>(model.textures.size()) - 1;
}

tinygltf::Node drawn_node(const Placement& place, UpAxis up) {
  tinygltf::Node node = placed_node(place, up);
  node.name = "O1";
  node.mesh = 0;
  return node;
}

}  // namespace sdm::io
