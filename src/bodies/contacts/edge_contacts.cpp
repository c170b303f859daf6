#include "bodies/contacts/edge_contacts.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "closest/single_point.h"
#include "core/cancellation.h"
#include "geometry/rounding.h"
#include "geometry/triangle_pair.h"
#include "sites/closest_on_face.h"

namespace sdm::contacts {
namespace {

constexpr double kSamePoint = 1e-6;  // of the length of the edge
// Faces continue each other where their heights differ by at most this part of them: the planes of faces of a
// curved surface are not the same, but the side and the top of a table are something else.
constexpr double kSameHeight = 0.1;

bool is_inside(const shape::Body& body, const Vec3& point) {
  if (!body.solid()) return false;
  constexpr double kAnywhere = kInfinity;
  return body.inside()(point, closest::closest_point(internals(body.sites()), point, kAnywhere));
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

// The points of an edge whose distances from the plane of a face are at most `limit`.
struct Slab {
  double height = 0, rise = 0;  // above the plane, at the start and along the edge
  double from = 0, to = 1;

  Slab(const EdgeContacts::Edge& edge, const Corners& face, const Vec3& normal, double limit)
      : height(dot(normal, edge.a - face[0])), rise(dot(normal, edge.b - edge.a)) {
    if (rise != 0) {
      const double up = (limit - height) / rise, down = (-limit - height) / rise;
      from = std::max(0.0, std::min(up, down));
      to = std::min(1.0, std::max(up, down));
    } else if (std::abs(height) > limit) {
      to = -1;
    }
  }
  [[nodiscard]] bool empty() const { return to < from; }
  // Where it is closest to the plane.
  [[nodiscard]] double closest() const { return rise == 0 ? from : std::clamp(-height / rise, from, to); }
  [[nodiscard]] double distance() const { return std::abs(height + closest() * rise); }
};

// Where the slab is, beside the prism above and below the face.
enum class BesidePrism : std::uint8_t {
  inside,  // as a whole: distances from the plane are those from the face
  across,
  beyond  // as a whole, and farther away than `limit`
};

BesidePrism beside_prism(const EdgeContacts::Edge& edge, const Corners& face, const Vec3& normal,
                         const Slab& slab, double limit) {
  const Vec3 along = edge.b - edge.a;
  BesidePrism result = BesidePrism::inside;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &start = face[k], &third = face[(k + 2) % 3];
    Vec3 wall = cross(normal, face[(k + 1) % 3] - start);
    if (dot(wall, third - start) < 0) wall = -wall;  // the face may be oriented inwards
    const double at_a = dot(wall, edge.a - start), rise = dot(wall, along);
    const double from = at_a + slab.from * rise, to = at_a + slab.to * rise;
    if (from > 0 && to > 0) continue;
    if (std::max(from, to) < -limit * norm(wall)) return BesidePrism::beyond;
    result = BesidePrism::across;
  }
  return result;
}

// The part of an edge within `limit` of a face, around the point closest to it, by bisection.
EdgeContacts::Part bisected(const EdgeContacts::Edge& edge, const sites::SitesData& sites, std::uint32_t face,
                            double limit, double closest) {
  const auto distance_at = [&](double t) {
    return sites::closest_on_face(sites, face, edge.a + t * (edge.b - edge.a)).distance;
  };
  return {last_within(distance_at, limit, closest, 0), last_within(distance_at, limit, closest, 1)};
}

}  // namespace

// The part of an edge within `limit` of a face, in closed form where there is one.
EdgeContacts::Part EdgeContacts::within(const Edge& edge, const sites::SitesData& sites, std::uint32_t face,
                                        double limit, double closest) {
  if (sites.sliver[face] == 0) {
    const Corners corners = corners_of(sites.mesh, face);
    const Vec3& normal = sites.normals.face[face];
    const Slab slab(edge, corners, normal, limit);
    if (!slab.empty() && beside_prism(edge, corners, normal, slab, limit) == BesidePrism::inside)
      return {slab.from, slab.to};
  }
  return bisected(edge, sites, face, limit, closest);
}

void EdgeContacts::add_interval(const Edge& edge, const sites::SitesData& sites, std::uint32_t face,
                                double limit) {
  const Corners corners = corners_of(sites.mesh, face), segment{edge.a, edge.b, edge.b};
  if (sites.sliver[face] == 0) {  // otherwise, its normal is rounding noise
    const Vec3& normal = sites.normals.face[face];
    const Slab slab(edge, corners, normal, limit);
    if (slab.empty()) return;
    const BesidePrism at = beside_prism(edge, corners, normal, slab, limit);
    if (at == BesidePrism::beyond) return;
    if (at == BesidePrism::inside) {
      intervals_.push_back({slab.from, slab.to, slab.distance(), slab.closest(), face});
      return;
    }
  }
  if (squared_box_distance(segment, corners) > limit * limit) return;
  const PointPair closest = closest_or_common(segment, corners);
  const double distance = std::sqrt(closest.squared);
  if (distance > limit) return;
  const Vec3 along = edge.b - edge.a;
  const double t = std::clamp(dot(closest.point1 - edge.a, along) / squared_norm(along), 0.0, 1.0);
  const Part part = bisected(edge, sites, face, limit, t);
  intervals_.push_back({part.from, part.to, distance, t, face});
}

void EdgeContacts::find_intervals(const Edge& edge, const shape::Body& other, double margin) {
  constexpr std::size_t kFewFaces = 64;
  const sites::SitesData& sites = internals(other.sites());
  const double rounding = kUnitDistanceRounding / sites.frame.scale, limit = margin + rounding;
  intervals_.clear();
  const std::span<const std::uint32_t> faces = faces_.find(sites, {edge.a, edge.b}, limit);
  if (faces.size() > kFewFaces) {
    find_intervals_of_many(edge, sites, faces, limit, rounding);
  } else {
    for (const std::uint32_t face : faces) {
      poll();
      add_interval(edge, sites, face, limit);
    }
  }
  std::ranges::sort(intervals_, {}, [](const Interval& i) { return std::pair(i.from, i.face); });
}

// Where a part of the edge touches a face, others change nothing there: in stacks of coplanar faces, and
// around an edge of many, most need no interval. Faces in whose plane the edge lies come first, as it may
// touch them on all of it.
void EdgeContacts::find_intervals_of_many(const Edge& edge, const sites::SitesData& sites,
                                          std::span<const std::uint32_t> faces, double limit,
                                          double rounding) {
  touching_.clear();
  const auto add = [&](std::uint32_t face) {
    poll();
    if (const Part part = beside_box(edge, sites, face, limit); part.from > part.to || touches(part)) return;
    const std::size_t before = intervals_.size();
    add_interval(edge, sites, face, limit);
    if (intervals_.size() == before || intervals_.back().distance > rounding) return;
    const Interval& i = intervals_.back();
    const double least = i.distance + rounding;
    add_touching(least >= limit ? Part{i.from, i.to} : within(edge, sites, face, least, i.closest));
  };
  const auto in_plane = [&](std::uint32_t face) {
    const Vec3& corner = sites.mesh.positions[sites.mesh.triangles[face][0]];
    const Vec3& normal = sites.normals.face[face];
    return sites.sliver[face] == 0 && std::abs(dot(normal, edge.a - corner)) <= rounding &&
           std::abs(dot(normal, edge.b - corner)) <= rounding;
  };
  for (const std::uint32_t face : faces)
    if (in_plane(face)) add(face);
  for (const std::uint32_t face : faces)
    if (!in_plane(face)) add(face);
}

// Where the edge is within `limit` of the box of a face, and a little more.
EdgeContacts::Part EdgeContacts::beside_box(const Edge& edge, const sites::SitesData& sites,
                                            std::uint32_t face, double limit) {
  const Corners corners = corners_of(sites.mesh, face);
  Part part{0, 1};
  for (int k = 0; k < 3; ++k) {
    const double lo = std::min({corners[0][k], corners[1][k], corners[2][k]}) - 2 * limit - edge.a[k],
                 hi = std::max({corners[0][k], corners[1][k], corners[2][k]}) + 2 * limit - edge.a[k],
                 along = edge.b[k] - edge.a[k];
    if (along == 0) {
      if (lo > 0 || hi < 0) return {1, 0};
      continue;
    }
    part.from = std::max(part.from, std::min(lo / along, hi / along));
    part.to = std::min(part.to, std::max(lo / along, hi / along));
  }
  return part;
}

bool EdgeContacts::touches(const Part& part) const {
  return std::ranges::any_of(touching_, [&](const Part& known) {
    return known.from <= part.from + kSamePoint && part.to <= known.to + kSamePoint;
  });
}

void EdgeContacts::add_touching(Part part) {
  std::erase_if(touching_, [&](const Part& known) {
    if (known.to < part.from || part.to < known.from) return false;
    part = {std::min(part.from, known.from), std::max(part.to, known.to)};
    return true;
  });
  touching_.push_back(part);
}

void EdgeContacts::find_supports(const Edge& edge, const shape::Body& other, double margin, double max_depth,
                                 double tolerance) {
  supported_.clear();
  parts_.clear();
  if (intervals_.empty() || max_depth == 0) return;
  const sites::SitesData& sites = internals(other.sites());
  // Only the parts in contact, which are between these, may be supported.
  double from = 1, to = 0;
  for (const Interval& i : intervals_) {
    from = std::min(from, i.from);
    to = std::max(to, i.to);
  }
  const Vec3 along = edge.b - edge.a;
  const FacesNearEdge::Segment in_contact{edge.a + from * along, edge.a + to * along};
  const double below = other.solid() ? max_depth : 0;  // a surface has no inside
  for (const std::uint32_t face : faces_.find_supporting(sites, in_contact, edge.sides, margin, below)) {
    poll();
    add_support(edge, other, face, margin, below);
  }
  std::ranges::sort(supported_, {}, [](const SupportedPart& p) { return std::tuple(p.from, p.to, p.face); });
  // Faces that continue each other support one part.
  for (std::size_t i = 0; i < supported_.size(); ++i) {
    const SupportedPart& part = supported_[i];
    const auto continued = std::ranges::find_if(parts_, [&](const JoinedPart& joined) {
      const double height = part.height_at(part.from), before = supported_[joined.last].height_at(part.from);
      return part.from <= joined.to + kSamePoint &&
             std::abs(height - before) <= kSameHeight * (std::abs(height) + std::abs(before)) + tolerance;
    });
    if (continued == parts_.end())
      parts_.push_back({part.from, part.to, i});
    else if (part.to > continued->to) {
      continued->to = part.to;
      continued->last = i;
    }
  }
}

void EdgeContacts::add_support(const Edge& edge, const shape::Body& other, std::uint32_t face, double margin,
                               double max_depth) {
  const sites::SitesData& sites = internals(other.sites());
  const Vec3 along = edge.b - edge.a;
  const std::array<Vec3, 2> both{along, -along};
  const Vec3& normal = sites.normals.face[face];
  if (!can_push(normal, both) || !can_push(normal, edge.sides) || !is_support(other, face)) return;
  const Clip clip = clip_to_prism(sites, face, edge.a, along, margin, max_depth);
  const Vec3& corner = sites.mesh.positions[sites.mesh.triangles[face][0]];
  if (clip.from < clip.to)
    supported_.push_back({clip.from, clip.to, face, dot(normal, edge.a - corner), dot(normal, along)});
}

// An end of a supported part, by the nearest of the faces that support it there. Returns false if this is not
// the way out of the surface beside it.
bool EdgeContacts::add_end(const Edge& edge, const shape::Body& other, double t, std::uint32_t number,
                           double tolerance) {
  if ((edge.a_touches && t < kSamePoint) || (edge.b_touches && t > 1 - kSamePoint)) return true;
  for (const Found& end : found_)
    if (end.support.face != kNone && std::abs(end.t - t) < kSamePoint) return true;
  Support nearest;
  for (const SupportedPart& part : supported_) {
    if (!(part.from - kSamePoint <= t && t <= part.to + kSamePoint)) continue;
    const double height = part.height_at(t);
    if (nearest.face == kNone || std::abs(height) < std::abs(nearest.height)) nearest = {part.face, height};
  }
  WayOut way_out{.place = WayOut::Place::here};
  if (nearest.height < -tolerance) {
    const SurfacePoint point = measure_near(other, edge.a + t * (edge.b - edge.a), nearest.face);
    way_out = way_out_.find(edge.around, other, nearest, point, tolerance);
    if (way_out.place == WayOut::Place::none) return false;
  }
  found_.push_back({.t = t, .support = nearest, .way_out = way_out, .number = number});
  return true;
}

std::span<const EdgeContacts::Found> EdgeContacts::find(const Edge& edge, const shape::Body& other,
                                                        double margin, double max_depth, double tolerance) {
  const sites::SitesData& sites = internals(other.sites());
  const Vec3 along = edge.b - edge.a;
  found_.clear();
  in_contact_.clear();
  find_intervals(edge, other, margin);
  find_supports(edge, other, margin, max_depth, tolerance);
  const double rounding = kUnitDistanceRounding / sites.frame.scale;
  std::uint32_t number = 0;  // of a supported end, whether it is found or not
  for (auto first = intervals_.begin(); first != intervals_.end();) {
    auto next = first;
    double end = first->to;
    while (++next != intervals_.end()) {
      // Ends of intervals are not accurate enough for a point between closer ones.
      if (next->from > end + kSamePoint && !is_inside(other, edge.a + 0.5 * (end + next->from) * along))
        break;
      end = std::max(end, next->to);
    }
    const bool from_a = edge.a_touches && first == intervals_.begin();
    const bool to_b = edge.b_touches && next == intervals_.end();
    const auto first_found = static_cast<std::uint32_t>(found_.size());
    bool supported = false;
    for (const JoinedPart& part : parts_)
      if (part.from <= end && first->from <= part.to) {
        const double from = std::max(part.from, first->from), to = std::min(part.to, end);
        supported |= add_end(edge, other, from, number, tolerance);
        if (to > from + kSamePoint) supported |= add_end(edge, other, to, number + 1, tolerance);
        number += 2;
      }
    if (!from_a && !to_b && !supported) {
      const auto nearest = std::min_element(
          first, next, [](const Interval& a, const Interval& b) { return a.distance < b.distance; });
      const double least = nearest->distance;
      double from = 1, to = 0;
      for (auto i = first; i != next; ++i) {
        if (!(i->distance <= least + rounding)) continue;
        const double limit = i->distance + rounding;
        const Part part = limit >= margin + rounding ? Part{i->from, i->to}
                                                     : within(edge, sites, i->face, limit, i->closest);
        from = std::min(from, part.from);
        to = std::max(to, part.to);
      }
      found_.push_back({.t = 0.5 * (from + to), .near_face = nearest->face});
    }
    in_contact_.push_back({{from_a ? 0 : first->from, to_b ? 1 : end},
                           from_a,
                           to_b,
                           first_found,
                           static_cast<std::uint32_t>(found_.size()),
                           first->face});
    first = next;
  }
  return found_;
}

}  // namespace sdm::contacts
