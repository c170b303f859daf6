#include "certify/tolerance/least_distance.h"

#include <algorithm>
#include <cmath>

#include "certify/hausdorff/vertex_search.h"
#include "core/parallel.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "tree/visit.h"

namespace sdm::tolerance {
namespace {

// Lowers `least` by the distance of a face of A.
void lower_by_face(const sites::SitesData& b, const Corners& corners, std::uint32_t face,
                   const hausdorff::Matching* matching, LeastDistance& least) {
  Box box;
  double size = 1;
  for (const Vec3& corner : corners) {
    const Vec3 unit = b.frame.to_unit(corner);
    extend(box, unit);
    for (const double x : unit) size = std::max(size, std::abs(x));
  }
  const tree::FloatBox around = tree::FloatBox::around(box);
  const auto bound = [&](std::uint32_t node, const tree::FloatBox& other) {
    if (matching != nullptr && !matching->may_allow(face, node))
      return std::numeric_limits<double>::infinity();
    return (1 - 1e-12) * norm(tree::gap(around, other)) - kFewRoundings * size;
  };
  const auto enter = [&](double distance) { return distance < least.value * b.frame.scale; };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t other : b.tree.items_of(node)) {
      if (matching != nullptr && !matching->allows(face, other)) continue;
      const Corners near = corners_of(b.mesh, other);
      if (!(squared_box_distance(corners, near) < least.value * least.value)) continue;
      const PointPair pair = closest_or_common(corners, near);
      if (const double distance = std::sqrt(pair.squared); distance < least.value)
        least = {distance, pair.point1, pair.point2, face, other};
    }
  };
  tree::visit(b.tree, tree::NearestFirst{bound, enter, leaf});
}

}  // namespace

LeastDistance least_distance(const Mesh& a, const sites::SitesData& b, double most,
                             const hausdorff::Matching* matching) {
  constexpr std::size_t kBlock = 256;
  const std::size_t blocks = (a.triangles.size() + kBlock - 1) / kBlock;
  std::vector<LeastDistance> found(blocks);
  parallel_for(blocks, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      found[i].value = most;
      for (std::size_t f = kBlock * i; f < std::min(kBlock * (i + 1), a.triangles.size()); ++f)
        if (!hausdorff::repeats_corner(a.triangles[f]))
          lower_by_face(b, corners_of(a, f), static_cast<std::uint32_t>(f), matching, found[i]);
    }
  });
  LeastDistance least{.value = most};
  for (const LeastDistance& block : found)
    if (block.value < least.value) least = block;
  return least;
}

}  // namespace sdm::tolerance
