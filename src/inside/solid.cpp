#include "inside/solid.h"

#include <sdm/error.h>
#include <sdm/sites.h>

#include <algorithm>
#include <new>

#include "core/cancellation.h"
#include "core/memory.h"
#include "geometry/predicates.h"
#include "geometry/rounding.h"
#include "inside/solid_boundary.h"
#include "tree/visit.h"

namespace sdm::inside {
namespace {

constexpr int kMostSegments = 100;

// A segment in the unit frame, and a bound on the rounding errors of its coordinates.
struct Segment {
  Vec3 start, along;
  Vec3 inverse_along;  ///< 0 for components so small that the coordinate stays where it is
  double rounding;

  Segment(const UnitFrame& frame, const Affine& pose, const Vec3& p, const Vec3& q) {
    const Affine back = inverse(pose);
    start = frame.to_unit(back(p));
    along = frame.to_unit(back(q)) - start;
    rounding = kDoubleRounding * (1 + norm(start) + norm(along));
    for (int k = 0; k < 3; ++k) inverse_along[k] = std::abs(along[k]) < kLeast ? 0 : 1 / along[k];
  }

  static constexpr double kLeast = 1e-300;  // far below `rounding`; its inverse is finite

  [[nodiscard]] bool meets(const tree::FloatBox& box) const {
    double first = 0, last = 1;
    for (int k = 0; k < 3; ++k) {
      const double lo = box.lower[k] - rounding - start[k], hi = box.upper[k] + rounding - start[k];
      if (inverse_along[k] == 0) {
        if (lo > 0 || hi < 0) return false;
        continue;
      }
      const auto [enter, leave] = std::minmax({lo * inverse_along[k], hi * inverse_along[k]});
      first = std::max(first, enter);
      last = std::min(last, leave);
    }
    constexpr double kQuotient = 1e-12;
    return first <= last + kQuotient;
  }
};

// If the segment pq crosses the triangle: 1 if it leaves through it (p is on the inner side), −1 if it
// enters. Otherwise 0; empty if it meets an edge of the triangle. Neither p nor q lies on the triangle.
std::optional<int> crossing(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
  const bool above_p = orientation(t[0], t[1], t[2], p) > 0, above_q = orientation(t[0], t[1], t[2], q) > 0;
  if (above_p == above_q) return 0;
  const int a = orientation(p, q, t[0], t[1]), b = orientation(p, q, t[1], t[2]),
            c = orientation(p, q, t[2], t[0]);
  const bool left = a > 0 || b > 0 || c > 0, right = a < 0 || b < 0 || c < 0;
  if (left && right) return 0;
  if (a * b * c == 0) return std::nullopt;
  return above_p ? -1 : 1;
}

}  // namespace

std::optional<int> crossings(const OrientedFaces& oriented, const Affine& pose, const Vec3& p,
                             const Vec3& q) {
  const FaceTree& faces = oriented.faces;
  const Segment segment(faces.frame, pose, p, q);
  poll();
  std::optional<int> turns = 0;
  const auto enter = [&](tree::Subtree below) { return turns && segment.meets(faces.tree.box(below.root)); };
  const auto visit_leaf = [&](std::uint32_t leaf) {
    for (const std::uint32_t face : faces.tree.items_of(leaf)) {
      const auto [a, b, c] = faces.triangles[face];
      const auto& at = faces.positions;
      const std::optional<int> sign = crossing(p, q, {pose(at[a]), pose(at[b]), pose(at[c])});
      if (!sign) return turns.reset();
      *turns += !oriented.inverted.empty() && oriented.inverted[face] ? -*sign : *sign;
    }
  };
  visit(faces.tree, tree::InOrder{enter, visit_leaf});
  return turns;
}

std::optional<int> winding(const sites::SitesData& sites, const Affine& pose, const Vec3& p, const Vec3& q) {
  return crossings(oriented_faces(sites), pose, p, q);
}

std::optional<int> crossings(const sites::SitesData& sites, const rays::Segment& segment,
                             const rays::NearNodes* near) {
  thread_local rays::Scratch scratch;
  poll();
  int turns = 0;
  bool decided = true;
  const auto cross = [&](std::uint32_t face) {
    const std::optional<int> sign = crossing(segment.p, segment.q, corners_of(sites.mesh, face));
    decided = sign.has_value();
    if (sign) turns += sites.inverted[face] != 0 ? -*sign : *sign;
    return !decided;
  };
  rays::visit_faces_on_segment(sites, segment, near, rays::visitor(cross), scratch);
  return decided ? std::optional(turns) : std::nullopt;
}

int winding(const sites::SitesData& solid, const Affine& pose, const Vec3& point) {
  if (solid.tree.nodes.empty()) return 0;
  return winding_by_segments(solid.face_tree(), pose, point, kMostSegments,
                             [&](const Vec3& q) { return winding(solid, pose, point, q); })
      .value_or(0);
}

int winding(const sites::SitesData& solid, const Vec3& point) {
  if (solid.tree.nodes.empty()) return 0;
  return winding_by_segments(solid.face_tree(), {}, point, kMostSegments,
                             [&](const Vec3& q) {
                               return crossings(solid, rays::Segment{point, q});
                             })
      .value_or(0);
}

}  // namespace sdm::inside

namespace sdm {

namespace {

void check_solid(const Sites& sites) {
  if (!internals(sites).is_solid()) throw Error("a mesh that is not closed and orientable has no volume");
}

}  // namespace

BoundedNumber solid_volume(const Sites& sites, const SolidVolumeOptions& options) try {
  check_solid(sites);
  const sites::SitesData& data = internals(sites);
  if (!(options.embedded ? *options.embedded : is_embedded(sites))) {
    const inside::SolidBoundary::Volume bounds =
        inside::SolidBoundary(data, inside::FaceSides(data)).volume();
    const bool exact = bounds.lower == bounds.upper;
    return {.value = exact ? bounds.lower : 0.5 * (bounds.lower + bounds.upper),
            .certainty = exact ? Certainty::exact : Certainty::bounded,
            .lower = bounds.lower,
            .upper = bounds.upper};
  }
  // The divergence theorem: tetrahedra between the faces and a point near them.
  double six_volumes = 0;
  for (const std::uint32_t face : data.tree.items) {
    const Triangle& t = data.mesh.triangles[face];
    const auto from_origin = [&](int k) { return data.mesh.positions[t[k]] - data.frame.origin; };
    const double six_volume = dot(from_origin(0), cross(from_origin(1), from_origin(2)));
    six_volumes += data.inverted[face] ? -six_volume : six_volume;
  }
  const double volume = six_volumes / 6;
  return {.value = volume, .certainty = Certainty::exact, .lower = volume, .upper = volume};
} catch (const std::bad_alloc&) {
  throw out_of_memory("the volume of a solid");
}

}  // namespace sdm
