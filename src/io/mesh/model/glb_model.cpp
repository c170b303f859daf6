#include "io/mesh/model/glb_model.h"

#include <map>
#include <numbers>

#include "geometry/vec.h"

namespace sdm::io {

Placement placement(const Box& box, const std::string& units) {
  static const std::map<std::string, double> metres{{"m", 1},     {"cm", 1e-2},   {"mm", 1e-3},
                                                    {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}};
  Placement result;
  if (const auto unit = metres.find(units); unit != metres.end()) result.scale = unit->second;
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
