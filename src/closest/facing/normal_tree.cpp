#include "closest/facing/normal_tree.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "closest/facing/normal_cones.h"
#include "sites/regions.h"

namespace sdm::facing {

tree::AabbTree normal_tree(const sites::SitesData& sites) {
  std::vector<tree::FloatBox> boxes(sites.mesh.triangles.size());
  std::vector<std::uint32_t> faces;
  for (const std::uint32_t face : sites.tree.items) {
    if (!has_normal(sites, face)) continue;
    Box box;
    extend(box, sites.normals.face[face]);
    boxes[face] = tree::FloatBox::around(box);
    faces.push_back(face);
  }
  return tree::build_aabb_tree(boxes, std::move(faces), sites::FaceBounds::kWidth);
}

}  // namespace sdm::facing
