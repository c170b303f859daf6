#include "bodies/contacts/feature_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/barycentric.h"
#include "geometry/rounding.h"
#include "geometry/unit_across.h"
#include "geometry/vec.h"
#include "sites/sites_data.h"

namespace sdm::contacts {
namespace {

using sites::SitesData;

// A corner at most this far, relative to the smaller body, from a face that cannot push it is flush with it.
constexpr double kFlush = 1.0 / 16;
// The sine of the angle by which all edges at a corner fall off behind its normal; 0.58 in a cube.
constexpr double kCorner = 0.25;
constexpr double kDirection = 1e-9;  // relative to the smaller body: the shortest vector with a direction
constexpr double kStraight = 1e-4;   // an angle: what an outline turns by at a corner, at least
// The kind of feature that a contact belongs to, in the upper bits of its number.
constexpr std::uint64_t kPart = std::uint64_t{1} << 60;
constexpr int kBodyBit = 63;

Vec3 weights_in(const Mesh& mesh, std::uint32_t face, const Vec3& p) {
  const auto& [a, b, c] = mesh.triangles[face];
  return barycentric(mesh.positions[a], mesh.positions[b], mesh.positions[c], p);
}

}  // namespace

void FeatureContacts::start(ContactCandidates& candidates) {
  candidates_ = &candidates;
  face_ = kNone;
  features_.clear();
  contacts_.clear();
  boxes_.clear();
  bridges_.clear();
}

void FeatureContacts::find_at_vertices(ContactCandidates& candidates, Regions regions) {
  start(candidates);
  for (std::size_t first = 0; first < regions.size();) {
    if (regions[first].kind == ContactRegion::Kind::coarse) {
      find_each(regions[first++]);
      continue;
    }
    std::size_t last = first + 1;
    while (last < regions.size() && regions[last].node == regions[first].node) ++last;
    find_deepest(regions.subspan(first, last - first));
    first = last;
  }
  for (const ContactRegion& region : regions) find_inside_edges(region);
  add_contacts();
}

// Adds the contact at the deepest vertex of a part, or of a region that is deep inside, and those of the
// corners on which it stands.
void FeatureContacts::find_deepest(Regions part) {
  const sites::SitesData& sites = internals(on().sites());
  const OneSidedVertices& vertices = candidates_->vertices();
  deepest_.start(on(), other(), to_other(), from_other());
  const auto owned = [&](std::uint32_t leaf) {
    return sites.regions.owners[sites.regions.leaves[leaf]].vertices;
  };
  for (const ContactRegion& region : part) {
    deepest_.start_group(region.near_face);
    const std::uint32_t first = owned(region.first_leaf), last = owned(region.last_leaf);
    if (region.is_inside()) {
      deepest_.add(first, last);
      continue;
    }
    for (std::uint32_t vertex = first; vertex < last; ++vertex) {
      if (vertices.is_free(vertex)) continue;
      if (const SurfacePoint* point = vertices.measured(vertex))
        deepest_.add(vertex, *point);
      else
        deepest_.add(vertex, vertex + 1);
    }
  }
  const DeepestVertex::Found found = deepest_.find(query().limit);
  const Box box = box_of(part);
  if (found.vertex != kNone)
    add_deepest(part, found, box);
  else if (box.lower[0] <= box.upper[0])
    bridges_.push_back(image(query().bodies[query().side]->pose().map, box));
}

void FeatureContacts::add_deepest(Regions part, const DeepestVertex::Found& deepest, const Box& box) {
  find_corners(part, deepest);
  const auto is_deepest = [&](const Corner& corner) { return corner.vertex == deepest.vertex; };
  // The key of a vertex that is the only one of its part is the part's, as which vertex is deepest changes
  // from frame to frame; that of a corner is the number of the corner.
  if (corners_.size() < 2 || std::ranges::none_of(corners_, is_deepest))
    features_.push_back({.key = kPart | part[0].node,
                         .site = internals(on().sites()).regions.points[deepest.vertex].vertex,
                         .point = deepest.point,
                         .faces = box});
  if (corners_.size() < 2) return;
  OneSidedVertices& vertices = candidates_->vertices();
  for (const Corner& corner : corners_) {
    Feature feature{.key = corner.site, .site = corner.site, .faces = box};
    const SurfacePoint* known = vertices.measured(corner.vertex);
    feature.point = is_deepest(corner) ? deepest.point
                    : known != nullptr ? *known
                                       : vertices.measure(corner.vertex, face_);
    if (!(feature.point.distance <= query().limit)) continue;
    find_support(feature);
    features_.push_back(feature);
  }
}

// The corners of a part that are as deep as its deepest vertex, but for a small angle: those of a foot on a
// floor. A body stands on the hull of such points, which may be much smaller than the body.
void FeatureContacts::find_corners(Regions part, const DeepestVertex::Found& deepest) {
  const SitesData& sites = internals(on().sites());
  const OneSidedVertices& vertices = candidates_->vertices();
  const Vec3 up = normalized(from_other().map.linear(outwards_at(deepest.point)));
  const Vec3 x = unit_across(up);
  const std::array<Vec3, 3> across{up, x, cross(up, x)};
  const auto at = [&](std::uint32_t vertex) {
    const auto& point = sites.regions.points[vertex].point;
    return Vec3{point[0], point[1], point[2]};
  };
  const Vec3 from = at(deepest.vertex);
  const auto owned = [&](std::uint32_t leaf) {
    return sites.regions.owners[sites.regions.leaves[leaf]].vertices;
  };
  corners_.clear();
  for (const ContactRegion& region : part) {
    if (region.kind == ContactRegion::Kind::deep) continue;  // smaller than its depth
    const std::uint32_t first = owned(region.first_leaf), last = owned(region.last_leaf);
    for (std::uint32_t vertex = first; vertex < last; ++vertex) {
      const Vec3 offset = at(vertex) - from;
      const double height = dot(up, offset);
      if (height * height > kPushSine * kPushSine * squared_norm(offset)) continue;
      if (!region.is_inside() && vertices.is_free(vertex)) continue;
      if (const std::uint32_t site = sites.regions.points[vertex].vertex; is_corner(site, across))
        corners_.push_back({vertex, site, offset});
    }
  }
  keep_hull(corners_, up);
}

// Whether a vertex is one of the outline of the faces that lie across `up`, a direction in the frame of the
// body: it can be pushed, and seen along that direction, all edges there are in less than a half-plane.
// `across`: that direction and two others.
bool FeatureContacts::is_corner(std::uint32_t vertex, const std::array<Vec3, 3>& across) const {
  const SitesData& sites = internals(on().sites());
  const auto& [up, x, y] = across;
  // The cone of the edges, from `right` to `left`.
  Vec2 right{}, left{};
  for (const std::uint32_t face : sites.vertex_faces.of(vertex))
    for (const std::uint32_t corner : sites.mesh.triangles[face]) {
      if (corner == vertex) continue;
      const Vec3 spoke = sites.mesh.positions[corner] - sites.mesh.positions[vertex];
      if (!can_push(up, std::span(&spoke, 1))) return false;
      const Vec2 seen{dot(x, spoke), dot(y, spoke)};
      if (dot(seen, seen) <= kPushSine * kPushSine * squared_norm(spoke)) continue;
      if (right == Vec2{}) right = left = seen;
      const double from_right = cross(right, seen), from_left = cross(left, seen);
      const bool straight =
          (from_right == 0 && dot(right, seen) < 0) || (from_left == 0 && dot(left, seen) < 0);
      if (straight || (from_right < 0 && from_left > 0)) return false;
      if (from_right < 0) right = seen;
      if (from_left > 0) left = seen;
    }
  const double sine = cross(right, left), cosine = dot(right, left);
  return cosine >= 0 || sine > -kStraight * cosine;
}

// Reduces the corners to kMostCorners: the points that are farthest in as many directions, which are spread
// by the length and the width of the hull.
void FeatureContacts::keep_hull(std::vector<Corner>& corners, const Vec3& up) {
  if (corners.size() <= kMostCorners) return;
  const auto farthest = [&](const auto& along) { return *std::ranges::max_element(corners, {}, along); };
  const auto squared = [](const Corner& c) { return squared_norm(c.offset); };
  const Vec3 from = farthest(squared).offset;
  const auto squared_from = [&](const Corner& c) { return squared_norm(c.offset - from); };
  const Vec3 to = farthest(squared_from).offset;
  const Vec3 length = to - from, across = cross(up, length);
  const auto side = [&](const Corner& c) { return dot(across, c.offset - from); };
  const auto width_at = [&](const Corner& c) { return std::abs(side(c)); };
  const double width = width_at(farthest(width_at));
  const double along_unit = 1 / squared_norm(length), side_unit = width > 0 ? 1 / width : 0;
  std::array<std::uint32_t, kMostCorners> kept;
  for (std::size_t i = 0; i < kMostCorners; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kMostCorners;
    const double u = std::cos(angle) * along_unit, v = std::sin(angle) * side_unit;
    kept[i] =
        farthest([&](const Corner& c) { return u * dot(length, c.offset - from) + v * side(c); }).vertex;
  }
  std::erase_if(corners, [&](const Corner& c) { return std::ranges::find(kept, c.vertex) == kept.end(); });
}

// A box of the faces that may be in contact.
Box FeatureContacts::box_of(Regions part) {
  const OneSidedVertices& vertices = candidates_->vertices();
  const sites::SitesData& sites = internals(on().sites());
  constexpr auto kBoxRounding = static_cast<float>(kSingleRounding);
  tree::FloatBox unit;
  unit.lower.fill(std::numeric_limits<float>::infinity());
  unit.upper.fill(-std::numeric_limits<float>::infinity());
  const auto extend_by = [&](std::span<const float, 3> lo, std::span<const float, 3> hi) {
    for (int k = 0; k < 3; ++k) {
      unit.lower[k] = std::min(unit.lower[k], lo[k] - kBoxRounding);
      unit.upper[k] = std::max(unit.upper[k], hi[k] + kBoxRounding);
    }
  };
  for (const ContactRegion& region : part) {
    if (region.is_inside()) {
      const tree::FloatBox& whole = sites.tree.box(region.source);
      extend_by(whole.lower, whole.upper);
      continue;
    }
    for (std::uint32_t leaf = region.first_leaf; leaf < region.last_leaf; ++leaf) {
      const std::uint32_t near = candidates_->near_faces(leaf), first = sites.regions.leaves[leaf];
      for (std::uint32_t i = first; i < sites.regions.leaves[leaf + 1]; ++i) {
        const Triangle& corners = sites.regions.places.corners[i];
        // The corners of a face that is not near are on the same side.
        const bool is_near = (near >> (i - first) & 1) != 0;
        if (vertices.is_free(corners[0]) &&
            (!is_near || (vertices.is_free(corners[1]) && vertices.is_free(corners[2]))))
          continue;
        for (const std::uint32_t corner : corners)
          extend_by(sites.regions.points[corner].point, sites.regions.points[corner].point);
      }
    }
  }
  if (unit.lower[0] > unit.upper[0]) return {};
  Box box;
  for (const auto& corner : {unit.lower, unit.upper})
    extend(box, sites.frame.origin + (1 / sites.frame.scale) * Vec3{corner[0], corner[1], corner[2]});
  return box;
}

// The tolerance of depths, in the frame of the other body: well below what bounds on the depth allow for.
double FeatureContacts::tolerance() const {
  return 0.5 * query().length / query().bodies[1 - query().side]->pose().scale;
}

// Each vertex in contact.
void FeatureContacts::find_each(const ContactRegion& region) {
  const sites::SitesData& sites = internals(on().sites());
  OneSidedVertices& vertices = candidates_->vertices();
  for (std::uint32_t leaf = region.first_leaf; leaf < region.last_leaf; ++leaf) {
    const auto owned = [&](std::uint32_t i) {
      return sites.regions.owners[sites.regions.leaves[i]].vertices;
    };
    for (std::uint32_t vertex = owned(leaf); vertex < owned(leaf + 1); ++vertex) {
      if (vertices.is_free(vertex)) continue;
      Feature feature{.site = sites.regions.points[vertex].vertex};
      feature.key = feature.site;
      const SurfacePoint* point = vertices.measured(vertex);
      feature.point = point ? *point : vertices.measure(vertex, face_);
      if (!(feature.point.distance <= query().limit)) continue;  // by rounding
      find_support(feature);
      extend_by_star(feature.faces, feature.site);
      features_.push_back(feature);
    }
  }
}

void FeatureContacts::extend_by_star(Box& box, std::uint32_t vertex) const {
  const SitesData& sites = internals(on().sites());
  for (const std::uint32_t face : sites.vertex_faces.of(vertex))
    for (const std::uint32_t corner : sites.mesh.triangles[face]) extend(box, sites.mesh.positions[corner]);
}

// The direction in which a point leaves the other body. That of a vector within the rounding of points is the
// direction of the face.
Vec3 FeatureContacts::outwards_at(const SurfacePoint& point) const {
  const double distance = norm(point.vector);
  if (!(distance > kDirection * query().size)) return internals(other().sites()).normals.face[point.face];
  return (point.distance < 0 ? 1 / distance : -1 / distance) * point.vector;
}

// A corner that is flush with a face that cannot push it is carried by another one.
void FeatureContacts::find_support(Feature& feature) {
  const SitesData& sites = internals(on().sites());
  const SurfacePoint& closest = feature.point;
  const double distance = norm(closest.vector);
  if (distance > std::max(query().limit, kFlush * query().size) || !at_boundary(other(), closest)) return;
  const Vec3 outwards = outwards_at(closest);
  spokes_.clear();
  for (const std::uint32_t face : sites.vertex_faces.of(feature.site))
    for (const std::uint32_t corner : sites.mesh.triangles[face])
      if (corner != feature.site)
        spokes_.push_back(
            to_other().map.linear(sites.mesh.positions[corner] - sites.mesh.positions[feature.site]));
  if (can_push(outwards, spokes_)) return;
  // A vertex in a smooth surface has no other direction in which nothing else of the body is in contact
  // sooner.
  const Vec3 own = normalized(to_other().map.linear(sites.normals.vertex[feature.site]));
  for (const Vec3& spoke : spokes_)
    if (dot(own, spoke) > -kCorner * norm(spoke)) return;
  const Support support =
      support_of_vertex(other(), closest.at, spokes_, query().limit,
                        other().solid() ? std::max(query().limit, kSupportReach * query().size) : 0);
  if (support.face == kNone) return;
  WayOut way_out{.place = WayOut::Place::here};
  if (support.height < -tolerance()) {
    const SurfaceAround around{&sites,
                               &to_other(),
                               &from_other(),
                               sites.vertex_faces.of(feature.site),
                               {feature.site, feature.site}};
    way_out = way_out_.find(around, other(), support, closest, tolerance());
  }
  if (way_out.place == WayOut::Place::here) feature.support = support;
  if (way_out.place == WayOut::Place::beside) {
    feature.point = way_out.point;
    feature.own_face = way_out.own_face;
  }
}

void FeatureContacts::add_contacts() {
  for (const Feature& feature : features_) add_contact(feature);
}

void FeatureContacts::add_contact(const Feature& feature) {
  const SitesData &sites = internals(on().sites()), &sites_of_other = internals(other().sites());
  const mesh::Similarity& pose = query().bodies[1 - query().side]->pose();
  SurfacePoint closest = feature.point;
  const Vec3& p = closest.at;
  bool is_boundary = true;
  if (const Support& support = feature.support; support.face != kNone) {
    closest.distance = support.height;
    closest.vector = -support.height * sites_of_other.normals.face[support.face];
    closest.face = support.face;
  } else
    is_boundary = at_boundary(other(), closest);
  const bool inside = other().solid() && closest.distance < 0;
  const Vec3 face_normal = sites_of_other.normals.face[closest.face];
  if (!is_boundary) {
    other().require_boundary();
    const auto boundary = other().boundary().closest(p);
    if (boundary.point) {
      closest.vector = *boundary.point - p;
      closest.face = boundary.face;
    }
  }
  const double depth = pose.scale * (inside ? norm(closest.vector) : -closest.distance);
  const Vec3 vector = pose.map.linear(closest.vector), point = pose.map(p);
  const Vec3 outwards = std::abs(depth) > query().length ? (1 / depth) * vector
                                                         : (1 / pose.scale) * pose.map.linear(face_normal);
  const std::uint32_t face = feature.own_face != kNone ? feature.own_face
                             : feature.edge            ? sites.topology.edge_faces(feature.site)[0]
                                                       : sites.vertex_faces.of(feature.site)[0];
  Contact contact{
      .point1 = point,
      .point2 = point + vector,
      .normal = query().side == 0 ? outwards : -outwards,
      .depth = depth,
      .on = {{{face, weights_in(sites.mesh, face, from_other().map(p))},
              {closest.face, weights_in(sites_of_other.mesh, closest.face, p + closest.vector)}}},
      .id = std::uint64_t(query().side) << kBodyBit | feature.key,
  };
  if (query().side == 1) {
    std::swap(contact.point1, contact.point2);
    std::swap(contact.on[0], contact.on[1]);
  }
  contacts_.push_back(contact);
  boxes_.push_back(image(query().bodies[query().side]->pose().map, feature.faces));
  if (!inside) extend(boxes_.back(), point + vector);  // across the gap
}

}  // namespace sdm::contacts
