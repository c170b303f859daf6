#include "io/mesh/gltf/gltf_transform.h"

#include <sdm/error.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace sdm::io {

GltfTransform gltf_transform(const Vec3& translation, const std::array<double, 4>& rotation,
                             const Vec3& scale) {
  const auto [x, y, z, w] = rotation;
  const double squared_length = x * x + y * y + z * z + w * w;
  if (squared_length == 0) throw Error("a rotation is a quaternion of length 0");
  // 2 for unit quaternions; those stored as integers, or in single precision, have another length.
  const double s = 2 / squared_length;
  GltfTransform t;
  t.linear = {{{1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)},
               {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)},
               {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)}}};
  for (std::size_t c = 0; c < 3; ++c) t.linear[c] = scale[c] * t.linear[c];
  t.offset = translation;
  return t;
}

GltfTransform gltf_matrix_transform(const std::array<double, 16>& m) {
  constexpr double kAffine = 1e-5;
  if (std::abs(m[3]) > kAffine || std::abs(m[7]) > kAffine || std::abs(m[11]) > kAffine ||
      std::abs(m[15] - 1) > kAffine)
    throw Error("a matrix is not affine: its last row is not 0 0 0 1");
  GltfTransform t;
  for (std::size_t c = 0; c < 3; ++c) t.linear[c] = {m[4 * c], m[4 * c + 1], m[4 * c + 2]};
  t.offset = {m[12], m[13], m[14]};
  return t;
}

GltfTransform gltf_node_transform(const nlohmann::json& node) {
  if (node.contains("matrix")) return gltf_matrix_transform(node["matrix"].get<std::array<double, 16>>());
  return gltf_transform(Vec3{node.value("translation", std::array<double, 3>{})},
                        node.value("rotation", std::array<double, 4>{0, 0, 0, 1}),
                        Vec3{node.value("scale", std::array<double, 3>{1, 1, 1})});
}

}  // namespace sdm::io
