#include "bodies/contacts/support.h"

#include <algorithm>
#include <cmath>

#include "core/cancellation.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "tree/visit.h"

namespace sdm::contacts {
namespace {

// Restricts the clip to value + t·slope >= 0.
void restrict_to(Clip& clip, double value, double slope) {
  if (slope > 0)
    clip.from = std::max(clip.from, -value / slope);
  else if (slope < 0)
    clip.to = std::min(clip.to, -value / slope);
  else if (value < 0)
    clip.to = clip.from - 1;
}

}  // namespace

Clip clip_to_prism(const sites::SitesData& sites, std::uint32_t face, const Vec3& a, const Vec3& along,
                   double margin, double max_depth) {
  const Triangle& corners = sites.mesh.triangles[face];
  const Vec3& normal = sites.normals.face[face];
  const double rounding = kUnitDistanceRounding / sites.frame.scale;
  const auto corner = [&](std::size_t k) -> const Vec3& { return sites.mesh.positions[corners[k]]; };
  const double height = dot(normal, a - corner(0)), rise = dot(normal, along);
  Clip clip;
  restrict_to(clip, margin + rounding - height, -rise);
  restrict_to(clip, max_depth + rounding + height, rise);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &start = corner(k), &third = corner((k + 2) % 3);
    Vec3 wall = normalized(cross(normal, corner((k + 1) % 3) - start));
    if (dot(wall, third - start) < 0) wall = -wall;  // the face may be oriented inwards
    restrict_to(clip, dot(wall, a - start) + rounding, dot(wall, along));
  }
  return clip;
}

bool is_support(const shape::Body& body, std::uint32_t face) {
  if (internals(body.sites()).normals.face[face] == Vec3{}) return false;
  if (!body.solid()) return true;
  return body.inside().sides().of_face(face) == inside::Sides::boundary;
}

Support support_of_vertex(const shape::Body& body, const Vec3& vertex, std::span<const Vec3> spokes,
                          double margin, double max_depth) {
  poll();
  const sites::SitesData& sites = internals(body.sites());
  Box box;
  const double most = std::max(margin, max_depth);
  const Vec3 around{most, most, most};
  extend(box, sites.frame.to_unit(vertex - around));
  extend(box, sites.frame.to_unit(vertex + around));
  const tree::FloatBox near = tree::FloatBox::around(box);
  Support best;
  const auto enter = [&](tree::Subtree subtree) {
    return squared_norm(gap(sites.tree.box(subtree.root), near)) == 0;
  };
  const auto compare = [&](std::uint32_t leaf) {
    for (const std::uint32_t face : sites.tree.items_of(leaf)) {
      const Vec3& normal = sites.normals.face[face];
      if (!can_push(normal, spokes) || !is_support(body, face)) continue;
      const Clip clip = clip_to_prism(sites, face, vertex, {}, margin, max_depth);
      if (clip.to < clip.from) continue;
      const double height = dot(normal, vertex - sites.mesh.positions[sites.mesh.triangles[face][0]]);
      if (best.face == kNone || std::abs(height) < std::abs(best.height) ||
          (std::abs(height) == std::abs(best.height) && face < best.face))
        best = {face, height};
    }
  };
  tree::visit(sites.tree, tree::InOrder{enter, compare});
  return best;
}

}  // namespace sdm::contacts
