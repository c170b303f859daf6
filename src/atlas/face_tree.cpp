#include "atlas/face_tree.h"

#include "core/vec.h"

namespace sdm {
namespace {

AabbTree build(const Surface::Impl& surface) {
  std::vector<std::uint8_t> owns(surface.mesh.triangles.size(), 0);
  for (const std::uint32_t texel : surface.samples) owns[surface.texel_faces[texel]] = 1;
  std::vector<std::uint32_t> faces;
  for (std::uint32_t face = 0; face < owns.size(); ++face)
    if (owns[face]) faces.push_back(face);

  const UnitFrame frame = UnitFrame::of(bounds(surface.mesh));
  std::vector<Box> boxes(owns.size());
  for (const std::uint32_t face : faces)
    for (const std::uint32_t vertex : surface.mesh.triangles[face])
      extend(boxes[face], frame.to_unit(surface.mesh.positions[vertex]));
  return build_aabb_tree(boxes, std::move(faces), 1);
}

}  // namespace

const AabbTree& face_tree(const Surface::Impl& surface) {
  std::call_once(surface.treed, [&] { surface.face_tree = build(surface); });
  return surface.face_tree;
}

}  // namespace sdm
