#include "io/mesh/model/glb_model.h"

#include <sdm/mesh.h>

#include <numbers>

#include "geometry/vec.h"

namespace sdm::io {

Placement placement(const Box& box, const std::string& units) {
  Placement result;
  result.scale = metres_per(units).value_or(1);
  if (norm(centre(box)) > 8 * diagonal(box)) result.origin = centre(box);
  if (!(diagonal(box) < std::numeric_limits<float>::max() / 8))
    throw Error("coordinates are too large for glTF's single precision; scale the mesh down");
  return result;
}

tinygltf::Node placed_node(const Placement& place, UpAxis up) {
  tinygltf::Node node;
  const auto& [x, y, z] = place.origin;
  const bool turned = up == UpAxis::z;  // (x, y, z) becomes (x, z, -y)
  for (const double t : turned ? Vec3{x, z, -y} : place.origin)
    if (place.origin != Vec3{}) node.translation.push_back(t * place.scale);
  if (turned) node.rotation = {-std::numbers::sqrt2 / 2, 0, 0, std::numbers::sqrt2 / 2};
  if (place.scale != 1) node.scale.assign(3, place.scale);
  return node;
}

}  // namespace sdm::io
