#include "proximity/contacts/edge_contacts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/geometry/triangle_pair.h"
#include "core/geometry/vec.h"
#include "engine/cpu/cpu_engine.h"
#include "sites/closest_on_face.h"

namespace sdm::contacts {
namespace {

constexpr double kRounding = 1e-9;   // of distances, relative to the size of the other body
constexpr double kSamePoint = 1e-6;  // of the length of the edge
// The sine of the largest angle, and more, between an edge and a face that supports it.
constexpr float kParallel = 0.051f;

bool is_inside(const shape::Body& body, const Vec3& point) {
  if (!body.solid()) return false;
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  return body.inside()(point, cpu::cpu_closest(internals(body.sites()), point, kAnywhere));
}

// Where a convex function that is at most `limit` at `in` first exceeds it on the way to `out`, to 1e-8;
// `out` if it does not. Mostly, that is close to `in`.
template <class Function>
double last_within(const Function& f, double limit, double in, double out) {
  constexpr double kStep = 1e-8;
  constexpr int kHalvings = 20;
  double beyond = in;
  for (double step = out < in ? -kStep : kStep; f(beyond) <= limit; step *= 64) {
    if (beyond == out) return out;
    in = beyond;
    beyond = std::abs(step) < std::abs(out - in) ? in + step : out;
  }
  if (std::abs(beyond - in) <= kStep) return beyond;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (in + beyond);
    (f(middle) <= limit ? in : beyond) = middle;
  }
  return in;
}

// Whether both ends of the edge are farther than this from the plane of a face, on one side of it.
bool beyond_plane(const EdgeContacts::Edge& edge, const sites::SitesData& sites, std::uint32_t face,
                  double distance) {
  if (sites.sliver[face] != 0) return false;  // its normal is rounding noise
  const Vec3 &normal = sites.normals.face[face],
             &corner = sites.mesh.positions[sites.mesh.triangles[face][0]];
  const double a = dot(normal, edge.a - corner), b = dot(normal, edge.b - corner);
  return std::min(a, b) > distance || std::max(a, b) < -distance;
}

// Part of the edge in the unit frame of the other body, in single precision.
struct UnitEdge {
  float start[3], along[3], inverse[3];

  UnitEdge(const EdgeContacts::Edge& edge, double from, double to, const UnitFrame& frame) {
    const Vec3 a = frame.to_unit(edge.a + from * (edge.b - edge.a)),
               b = frame.to_unit(edge.a + to * (edge.b - edge.a));
    for (int k = 0; k < 3; ++k) {
      constexpr float kLeast = 1e-12f;  // parallel to the sides of boxes
      start[k] = static_cast<float>(a[k]), along[k] = static_cast<float>(b[k] - a[k]);
      inverse[k] = 1 / (std::abs(along[k]) < kLeast ? kLeast : along[k]);
    }
  }

  // The children whose boxes, enlarged by `reach`, it passes.
  [[nodiscard]] std::uint32_t passes(const hierarchy::WideTree::Node& node, float reach) const {
    constexpr int kWidth = hierarchy::WideTree::kWidth;
    float from[kWidth] = {}, to[kWidth];
    std::ranges::fill(to, 1.0f);
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < kWidth; ++i) {
        const float lo = (node.lo[k][i] - reach - start[k]) * inverse[k],
                    hi = (node.hi[k][i] + reach - start[k]) * inverse[k];
        from[i] = std::max(from[i], std::min(lo, hi));
        to[i] = std::min(to[i], std::max(lo, hi));
      }
    std::uint32_t children = 0;
    for (int i = 0; i < kWidth; ++i) children |= std::uint32_t{from[i] <= to[i]} << i;
    return children & ((1u << node.count) - 1);
  }
};

// Calls visit(leaf) for the numbers of the leaves whose boxes the edge passes, enlarged by `reach`.
template <class Visit>
void for_leaves_near(const UnitEdge& edge, const sites::SitesData& sites, double reach, const Visit& visit) {
  constexpr double kUnitRounding = 1e-6;
  const auto distance = static_cast<float>(sites.frame.scale * reach + kUnitRounding);
  thread_local std::vector<std::uint32_t> stack;
  stack.assign(1, 0);
  while (!stack.empty()) {
    const hierarchy::WideTree::Node& node = sites.wide.nodes[stack.back()];
    stack.pop_back();
    for (std::uint32_t open = edge.passes(node, distance); open != 0; open &= open - 1) {
      const std::uint32_t child = node.child[std::countr_zero(open)];
      if (hierarchy::WideTree::is_leaf(child))
        visit(hierarchy::WideTree::leaf_number(child));
      else
        stack.push_back(child);
    }
  }
}

// Faces that may support an edge: nearly parallel to it, and above or below it.
class ParallelFaces {
 public:
  explicit ParallelFaces(const UnitEdge& edge) {
    const Vec3 direction = normalized({edge.along[0], edge.along[1], edge.along[2]});
    for (int k = 0; k < 3; ++k) start_[k] = edge.start[k], along_[k] = static_cast<float>(direction[k]);
  }

  // A bit for each face of a leaf.
  [[nodiscard]] std::uint32_t of_leaf(const sites::FaceBounds& bounds) const {
    std::uint8_t open[sites::FaceBounds::kWidth];
    for (int i = 0; i < sites::FaceBounds::kWidth; ++i) {
      const float n[3] = {bounds.normal[0][i], bounds.normal[1][i], bounds.normal[2][i]};
      const float sine = along_[0] * n[0] + along_[1] * n[1] + along_[2] * n[2];
      // The direction across the edge and in the plane of the face, and how far the face is from the edge
      // there.
      const float across[3] = {along_[1] * n[2] - along_[2] * n[1], along_[2] * n[0] - along_[0] * n[2],
                               along_[0] * n[1] - along_[1] * n[0]};
      float beside = 0;
      for (int k = 0; k < 3; ++k) beside += across[k] * (bounds.centre[k][i] - start_[k]);
      open[i] = static_cast<std::uint8_t>((std::abs(sine) < kParallel) &
                                          (std::abs(beside) < bounds.radius[i] + kSlack));
    }
    std::uint32_t faces = 0;
    for (int i = 0; i < sites::FaceBounds::kWidth; ++i) faces |= std::uint32_t{open[i]} << i;
    return faces;
  }

 private:
  static constexpr float kSlack = 1e-6f;  // rounding
  float start_[3], along_[3];
};

// Calls visit(face) for the faces of a leaf.
template <class Visit>
void for_faces(const sites::SitesData& sites, std::uint32_t leaf, const Visit& visit) {
  for (std::uint32_t i = sites.regions.leaves[leaf]; i < sites.regions.leaves[leaf + 1]; ++i)
    visit(sites.regions.owners[i].face);
}

}  // namespace

void EdgeContacts::find_intervals(const Edge& edge, const shape::Body& other, double margin) {
  const sites::SitesData& sites = internals(other.sites());
  const Vec3 along = edge.b - edge.a;
  const double rounding = kRounding / sites.frame.scale, limit = margin + rounding;
  intervals_.clear();
  const auto add = [&](std::uint32_t face) {
    const auto& [i, j, k] = sites.mesh.triangles[face];
    const Corners corners{sites.mesh.positions[i], sites.mesh.positions[j], sites.mesh.positions[k]};
    const Corners segment{edge.a, edge.b, edge.b};
    if (beyond_plane(edge, sites, face, limit + rounding)) return;
    if (squared_box_distance(segment, corners) > limit * limit) return;
    const PointPair closest = closest_or_common(segment, corners);
    const double distance = std::sqrt(closest.squared);
    if (distance > limit) return;
    const auto distance_at = [&](double t) {
      return sites::closest_on_face(sites, face, edge.a + t * along).distance;
    };
    const double t = std::clamp(dot(closest.point1 - edge.a, along) / squared_norm(along), 0.0, 1.0);
    intervals_.push_back({.from = last_within(distance_at, limit, t, 0),
                          .to = last_within(distance_at, limit, t, 1),
                          .distance = distance,
                          .closest = t,
                          .face = face});
  };
  for_leaves_near(UnitEdge(edge, 0, 1, sites.frame), sites, limit,
                  [&](std::uint32_t leaf) { for_faces(sites, leaf, add); });
  std::ranges::sort(intervals_, {}, &Interval::from);
}

void EdgeContacts::find_supports(const Edge& edge, const shape::Body& other, double margin, double reach) {
  supported_.clear(), parts_.clear();
  if (intervals_.empty() || reach == 0) return;
  const sites::SitesData& sites = internals(other.sites());
  // Only the parts in contact, which are between these, may be supported.
  double from = 1, to = 0;
  for (const Interval& i : intervals_) from = std::min(from, i.from), to = std::max(to, i.to);
  const UnitEdge in_contact(edge, from, to, sites.frame);
  const ParallelFaces parallel(UnitEdge(edge, 0, 1, sites.frame));
  for_leaves_near(in_contact, sites, std::max(margin, reach), [&](std::uint32_t leaf) {
    const std::uint32_t first = sites.regions.leaves[leaf];
    std::uint32_t faces = parallel.of_leaf(sites.regions.bounds[leaf]);
    faces &= (1u << (sites.regions.leaves[leaf + 1] - first)) - 1;
    for (; faces != 0; faces &= faces - 1)
      add_support(edge, other, sites.regions.owners[first + std::countr_zero(faces)].face, margin, reach);
  });
  std::ranges::sort(supported_, {}, [](const SupportedPart& p) { return std::tuple(p.from, p.to, p.face); });
  // Faces that continue each other support one part.
  for (const SupportedPart& part : supported_)
    if (!parts_.empty() && part.from <= parts_.back().to + kSamePoint)
      parts_.back().to = std::max(parts_.back().to, part.to);
    else
      parts_.push_back({part.from, part.to});
}

void EdgeContacts::add_support(const Edge& edge, const shape::Body& other, std::uint32_t face, double margin,
                               double reach) {
  const sites::SitesData& sites = internals(other.sites());
  const Vec3 along = edge.b - edge.a;
  const std::array<Vec3, 2> both{along, -along};
  const Vec3& normal = sites.normals.face[face];
  if (!can_push(normal, both) || !can_push(normal, edge.sides) || !is_support(other, face)) return;
  const Clip clip = clip_to_prism(sites, face, edge.a, along, margin, reach);
  if (clip.from < clip.to) supported_.push_back({clip.from, clip.to, face});
}

// An end of a supported part, by the nearest of the faces that support it there.
void EdgeContacts::add_end(const Edge& edge, const sites::SitesData& sites, double t) {
  if ((edge.a_touches && t < kSamePoint) || (edge.b_touches && t > 1 - kSamePoint)) return;
  Support nearest;
  for (const SupportedPart& part : supported_) {
    if (!(part.from - kSamePoint <= t && t <= part.to + kSamePoint)) continue;
    const Vec3& corner = sites.mesh.positions[sites.mesh.triangles[part.face][0]];
    const double height = dot(sites.normals.face[part.face], edge.a + t * (edge.b - edge.a) - corner);
    if (nearest.face == kNone || std::abs(height) < std::abs(nearest.height)) nearest = {part.face, height};
  }
  found_.push_back({t, nearest});
}

std::span<const EdgeContacts::Found> EdgeContacts::find(const Edge& edge, const shape::Body& other,
                                                        double margin, double reach) {
  const sites::SitesData& sites = internals(other.sites());
  const Vec3 along = edge.b - edge.a;
  found_.clear();
  find_intervals(edge, other, margin);
  find_supports(edge, other, margin, reach);
  const double rounding = kRounding / sites.frame.scale;
  for (auto first = intervals_.begin(); first != intervals_.end();) {
    auto next = first;
    double end = first->to;
    while (++next != intervals_.end()) {
      if (next->from > end && !is_inside(other, edge.a + 0.5 * (end + next->from) * along)) break;
      end = std::max(end, next->to);
    }
    const bool from_a = edge.a_touches && first == intervals_.begin();
    const bool to_b = edge.b_touches && next == intervals_.end();
    bool supported = false;
    for (const Part& part : parts_)
      if (part.from <= end && first->from <= part.to) {
        supported = true;
        const double from = std::max(part.from, first->from), to = std::min(part.to, end);
        add_end(edge, sites, from);
        if (to > from + kSamePoint) add_end(edge, sites, to);
      }
    if (!from_a && !to_b && !supported) {
      const double least = std::min_element(first, next, [](const Interval& a, const Interval& b) {
                             return a.distance < b.distance;
                           })->distance;
      double from = 1, to = 0;
      for (auto i = first; i != next; ++i) {
        if (!(i->distance <= least + rounding)) continue;
        const auto distance_at = [&](double t) {
          return sites::closest_on_face(sites, i->face, edge.a + t * along).distance;
        };
        from = std::min(from, last_within(distance_at, i->distance + rounding, i->closest, 0));
        to = std::max(to, last_within(distance_at, i->distance + rounding, i->closest, 1));
      }
      found_.push_back({.t = 0.5 * (from + to)});
    }
    first = next;
  }
  return found_;
}

}  // namespace sdm::contacts
