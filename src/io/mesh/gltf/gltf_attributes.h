// What the vertices of glTF's primitives have besides positions.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "io/mesh/gltf/document/gltf_document.h"
#include "io/mesh/gltf/gltf_skin.h"
#include "io/mesh/polygons/polygon_attributes.h"

namespace sdm::io {

/// Collects the attributes of primitives whose vertices are concatenated: NORMAL as `normal`, COLOR_0 as
/// `color` with four components, TEXCOORD_1 and so on as `uv1`, the application's own by their names. Those
/// of TANGENT, JOINTS_n and WEIGHTS_n are left out. Vertices of a primitive without an attribute hold NaN.
class GltfAttributes {
 public:
  /// The primitive's vertices follow the `first_vertex` before it. `morphed`: they are displaced, so that the
  /// normals of the file are not theirs. Throws sdm::Error if an attribute differs in its number of rows.
  void add(const GltfDocument& document, const nlohmann::json& attributes, const GltfPlacement& placement,
           std::size_t first_vertex, std::size_t vertices, bool morphed);

  /// `vertices`: of all primitives.
  [[nodiscard]] std::vector<PolygonAttribute> take(std::size_t vertices);

 private:
  /// The values of an array up to a vertex; null if the array has another number of components.
  std::vector<float>* array(const std::string& name, std::size_t components, std::size_t first_vertex);

  std::vector<PolygonAttribute> arrays_;
};

}  // namespace sdm::io
