#include "proximity/contacts/edge_contacts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>

#include "core/geometry/triangle_pair.h"
#include "core/geometry/vec.h"
#include "engine/cpu/cpu_engine.h"
#include "hierarchy/traverse.h"
#include "sites/closest_on_face.h"

namespace sdm::contacts {
namespace {

constexpr double kRounding = 1e-9;   // of distances, relative to the size of the other body
constexpr double kSamePoint = 1e-6;  // of the length of the edge

bool is_inside(const shape::Body& body, const Vec3& point) {
  if (!body.solid()) return false;
  bool inside = false;
  const auto take = [&](std::size_t, const sites::ClosestPacket& closest) {
    inside = body.inside()({&point, 1}, closest) != 0;
  };
  cpu::cpu_search(internals(body.sites()), {&point, 1}, std::numeric_limits<double>::infinity(),
                  std::ref(take));
  return inside;
}

// Where a convex function that is at most `limit` at `in` first exceeds it on the way to `out`; `out` if it
// does not.
template <class Function>
double last_within(const Function& f, double limit, double in, double out) {
  if (f(out) <= limit) return out;
  for (int i = 0; i < 48; ++i) {
    const double middle = 0.5 * (in + out);
    (f(middle) <= limit ? in : out) = middle;
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

// Calls visit(face) for the faces in leaves within `reach` of the box of the edge.
template <class Visit>
void for_faces_near(const EdgeContacts::Edge& edge, const sites::SitesData& sites, double reach,
                    const Visit& visit) {
  Box box;
  for (const Vec3& end : {edge.a, edge.b}) {
    extend(box, sites.frame.to_unit(end - Vec3{reach, reach, reach}));
    extend(box, sites.frame.to_unit(end + Vec3{reach, reach, reach}));
  }
  const hierarchy::FloatBox around = hierarchy::FloatBox::around(box);
  const auto near = [&](hierarchy::Subtree subtree) {
    return squared_norm(gap(sites.tree.box(subtree.root), around)) == 0;
  };
  hierarchy::traverse(sites.tree, hierarchy::whole(sites.tree), near, [&](std::uint32_t leaf) {
    for (const std::uint32_t face : sites.tree.items_of(leaf)) visit(face);
  });
}

}  // namespace

void EdgeContacts::find_intervals(const Edge& edge, const shape::Body& other, double margin) {
  const sites::SitesData& sites = internals(other.sites());
  const Vec3 along = edge.b - edge.a;
  const double rounding = kRounding / sites.frame.scale, limit = margin + rounding;
  intervals_.clear();
  for_faces_near(edge, sites, limit, [&](std::uint32_t face) {
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
                          .first_closest = last_within(distance_at, distance + rounding, t, 0),
                          .last_closest = last_within(distance_at, distance + rounding, t, 1)});
  });
  std::ranges::sort(intervals_, {}, &Interval::from);
}

void EdgeContacts::find_supports(const Edge& edge, const shape::Body& other, double margin, double reach) {
  supported_.clear(), parts_.clear();
  if (intervals_.empty() || reach == 0) return;
  for_faces_near(edge, internals(other.sites()), std::max(margin, reach),
                 [&](std::uint32_t face) { add_support(edge, other, face, margin, reach); });
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
      for (auto i = first; i != next; ++i)
        if (i->distance <= least + rounding)
          from = std::min(from, i->first_closest), to = std::max(to, i->last_closest);
      found_.push_back({.t = 0.5 * (from + to)});
    }
    first = next;
  }
  return found_;
}

}  // namespace sdm::contacts
