#include "bodies/solids/mesh_distance.h"

#include <algorithm>
#include <cmath>

#include "geometry/triangle_pair.h"
#include "geometry/vec.h"
#include "tree/visit.h"

namespace sdm::solids {
namespace {

// A core as a segment with a radius that contains it, in the unit frame of a mesh.
class Around {
 public:
  Around(const shape::PosedBody& mesh, const PosedCore& core) : frame_(internals(mesh.body().sites()).frame) {
    const Affine inverse_pose = inverse(mesh.pose().map);
    const auto to_unit = [&](const Vec3& p) { return frame_.to_unit(inverse_pose(p)); };
    const bool axis = core.kind() == CoreKind::axis;
    from_ = to_unit(core.centre() - core.half());
    to_ = to_unit(core.centre() + core.half());
    unit_ = mesh.pose().scale / frame_.scale;
    const double reach = axis ? core.disc() : core.body().ball().radius;
    radius_ = reach / unit_;
    // The rounding of points in the unit frame, which contains the mesh; the core may be far away.
    rounding_ = 1e-12 * (1 + norm(from_) + norm(to_) + radius_ + norm(core.centre()) / unit_);
  }

  // A lower bound, in space, on the distance of what is in a box.
  [[nodiscard]] double distance(const tree::FloatBox& box) const {
    Vec3 middle, half, gap;
    for (int k = 0; k < 3; ++k) {
      middle[k] = 0.5 * (double{box.lower[k]} + box.upper[k]);
      half[k] = 0.5 * (double{box.upper[k]} - box.lower[k]);
      gap[k] = std::max(
          {0.0, box.lower[k] - std::max(from_[k], to_[k]), std::min(from_[k], to_[k]) - box.upper[k]});
    }
    const double to_ball = norm(middle - closest_on_segment(middle, from_, to_)) - norm(half);
    return unit_ * (std::max(norm(gap), to_ball) - radius_ - rounding_);
  }

 private:
  const UnitFrame& frame_;
  Vec3 from_, to_;
  double unit_ = 1, radius_ = 0, rounding_ = 0;
};

Corners posed_corners(const shape::PosedBody& mesh, std::uint32_t face) {
  const Mesh& m = internals(mesh.body().sites()).mesh;
  const auto& [a, b, c] = m.triangles[face];
  const Affine& pose = mesh.pose().map;
  return {pose(m.positions[a]), pose(m.positions[b]), pose(m.positions[c])};
}

// Segments and points are compared with triangles as triangles are; other cores by their support functions.
FaceDistance distance_of_face(const shape::PosedBody& mesh, const PosedCore& core, std::uint32_t face) {
  const Corners corners = posed_corners(mesh, face);
  FaceDistance found;
  if (core.thin()) {
    const Vec3 from = core.centre() - core.half(), to = core.centre() + core.half();
    const PointPair points = closest_or_common(corners, {from, to, to});
    found.distance = std::sqrt(points.squared);
    found.point1 = points.point1;
    found.point2 = points.point2;
    if (found.distance > 0) found.normal = (1 / found.distance) * (found.point1 - found.point2);
  } else {
    static_cast<CoreDistance&>(found) = core_gap(PosedCore(corners[0], corners[1], corners[2]), core);
  }
  found.face = face;
  return found;
}

template <class Limit, class Add>
struct Visitor {
  const shape::PosedBody& mesh;
  const PosedCore& core;
  const Around around;
  const Limit& limit;
  const Add& add;

  [[nodiscard]] double bound(const tree::FloatBox& box) const { return around.distance(box); }
  [[nodiscard]] bool enter(double bound) const { return bound <= limit(); }
  void leaf(std::uint32_t index) const {
    for (const std::uint32_t face : internals(mesh.body().sites()).tree.items_of(index))
      if (const FaceDistance found = distance_of_face(mesh, core, face); found.distance <= limit())
        add(found);
  }
};

template <class Limit, class Add>
void visit_near(const shape::PosedBody& mesh, const PosedCore& core, const Limit& limit, const Add& add) {
  const tree::AabbTree& tree = internals(mesh.body().sites()).tree;
  if (tree.nodes.empty()) return;
  tree::visit(tree, Visitor<Limit, Add>{mesh, core, Around(mesh, core), limit, add});
}

}  // namespace

FaceDistance nearest_face(const shape::PosedBody& mesh, const PosedCore& core, double most) {
  FaceDistance nearest{{.distance = most}};
  visit_near(
      mesh, core, [&] { return nearest.distance; },
      [&](const FaceDistance& found) {
        if (found.distance < nearest.distance || found.face < nearest.face) nearest = found;
      });
  return nearest;
}

void faces_within(const shape::PosedBody& mesh, const PosedCore& core, double distance,
                  std::vector<FaceDistance>& found) {
  found.clear();
  visit_near(
      mesh, core, [&] { return distance; }, [&](const FaceDistance& face) { found.push_back(face); });
  std::ranges::sort(found, {}, &FaceDistance::face);
}

}  // namespace sdm::solids
