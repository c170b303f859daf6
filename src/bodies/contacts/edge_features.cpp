#include "bodies/contacts/edge_features.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <span>

#include "bodies/contacts/feature_contacts.h"
#include "geometry/vec.h"
#include "sites/closest_on_face.h"
#include "sites/sites_data.h"

namespace sdm::contacts {
namespace {

constexpr std::size_t kMostMeasured = 8;
// A point is deep enough if no other is deeper by more than this factor.
constexpr double kNearlyDeepest = 1.25;
// Values whose ratio is less are equal: rounding, which depends on the pose, would choose between them.
constexpr double kGreater = 1 + 1e-6;

// Edges with an end in contact have contacts between their ends only if they are longer than this part of the
// smaller body: of shorter ones, the end is near enough.
constexpr double kShortEdge = 1.0 / 16;
// Edges longer than kLongEdge, relative to the smaller body: each part that ends at the surface of the other
// body, or comes within the margin of it, has a contact at least half as deep as any of its points, but for a
// fraction of the length of the edge. No point of a shorter edge is deeper than its ends by more than half of
// that length.
constexpr double kLongEdge = 2 * kShortEdge, kMuchDeeper = 2, kDeeper = 1.0 / 8;
// The sine of the angle between faces below which their edge is flat: its points are in contact no sooner
// than those of the faces.
constexpr double kFlat = 1e-4;

// The kind of feature that a contact belongs to, in the upper bits of its number; kPart is another one.
constexpr std::uint64_t kEdge = std::uint64_t{2} << 60;
// Between the numbers of contacts on one edge.
constexpr std::uint64_t kNextOnEdge = std::uint64_t{1} << 32;
// Marks an end of a supported part, which keeps its number if the other end is lost. Other points have the
// number of the part of the edge in contact that they are on, whether they are in its middle or deep.
constexpr std::uint64_t kSupported = std::uint64_t{1} << 59;

// Whether the edge may be closer to another body than both faces beside it: if it is an edge of the boundary,
// or convex.
bool is_sharp(const sites::SitesData& sites, std::uint32_t edge) {
  const std::span<const std::uint32_t> faces = sites.topology.edge_faces(edge);
  if (faces.size() != 2) return true;
  const auto [a, b] = sites.topology.edges[edge];
  const Vec3& start = sites.mesh.positions[a];
  const Vec3& normal = sites.normals.face[faces[0]];
  for (const std::uint32_t corner : sites.mesh.triangles[faces[1]]) {
    if (corner == a || corner == b) continue;
    const Vec3 side = sites.mesh.positions[corner] - start;
    const double height = dot(normal, side), flat = kFlat * norm(side);
    return sites.is_solid() ? height < -flat : std::abs(height) > flat;
  }
  return true;
}

}  // namespace

double most_between(const EdgeInside& line) {
  return 0.5 * (line.from_depth + line.to_depth + norm(line.to - line.from));
}

SurfacePoint deep_point(const shape::Body& solid, const EdgeInside& line, double enough,
                        std::uint32_t near_face) {
  std::array<EdgeInside, kMostMeasured + 1> parts{line};
  SurfacePoint deepest{.distance = -enough};
  for (std::size_t count = 1; count <= kMostMeasured; ++count) {
    std::size_t highest = 0;
    for (std::size_t i = 1; i < count; ++i)
      if (most_between(parts[i]) > kGreater * most_between(parts[highest])) highest = i;
    EdgeInside& part = parts[highest];
    if (most_between(part) <= std::max(enough, kNearlyDeepest * -deepest.distance)) break;
    const Vec3 along = part.to - part.from;
    const double length = norm(along);
    const double t = std::clamp(0.5 + 0.5 * (part.to_depth - part.from_depth) / length, 0.0, 1.0);
    const SurfacePoint point = measure_near(solid, part.from + t * along, near_face);
    near_face = point.face;
    if (point.distance < kGreater * deepest.distance) deepest = point;
    parts[count] = {point.at, part.to, -point.distance, part.to_depth};
    part.to = point.at;
    part.to_depth = -point.distance;
  }
  return deepest;
}

// Only edges of near faces pass through the surface or are within the margin of it, and those that have an
// end in contact have others only if they are long.
void FeatureContacts::find_at_edges(ContactCandidates& candidates, std::span<const std::uint32_t> leaves) {
  start(candidates);
  const sites::SitesData& sites = internals(on().sites());
  OneSidedVertices& vertices = candidates_->vertices();
  const double shortest = kShortEdge * query().size;
  for (const std::uint32_t leaf : leaves) {
    const std::uint32_t first = sites.regions.leaves[leaf];
    for (std::uint32_t near = candidates_->near_faces(leaf); near != 0; near &= near - 1) {
      const std::uint32_t place = first + static_cast<std::uint32_t>(std::countr_zero(near));
      const std::uint32_t face = sites.regions.owners[place].face;
      for (const std::uint32_t edge : sites.topology.face_edges[face]) {
        if (edge == kNone || sites.topology.edge_faces(edge)[0] != face) continue;
        const auto [a, b] = sites.topology.edges[edge];
        const double length = to_other().scale * norm(sites.mesh.positions[b] - sites.mesh.positions[a]);
        if (!(length > 0) || !is_sharp(sites, edge)) continue;
        const Triangle &corners = sites.mesh.triangles[face], &places = sites.regions.places.corners[place];
        bool touches[2] = {};
        for (int k = 0; k < 3; ++k) {
          if (corners[k] == a) touches[0] = vertices.in_contact(places[k], face_);
          if (corners[k] == b) touches[1] = vertices.in_contact(places[k], face_);
        }
        const bool is_long = length > shortest;
        if ((touches[0] || touches[1]) && !is_long) continue;
        find_on_edge(edge, touches[0], touches[1], is_long ? kSupportReach * query().size : 0);
      }
    }
  }
  add_contacts();
}

void FeatureContacts::find_on_edge(std::uint32_t edge, bool a_touches, bool b_touches, double max_depth) {
  const sites::SitesData& sites = internals(on().sites());
  const auto [a, b] = sites.topology.edges[edge];
  const Vec3 start = to_other().map(sites.mesh.positions[a]), end = to_other().map(sites.mesh.positions[b]);
  spokes_.clear();
  Box faces;
  for (const std::uint32_t beside : sites.topology.edge_faces(edge))
    for (const std::uint32_t corner : sites.mesh.triangles[beside]) {
      extend(faces, sites.mesh.positions[corner]);
      if (corner != a && corner != b)
        spokes_.push_back(to_other().map.linear(sites.mesh.positions[corner] - sites.mesh.positions[a]));
    }
  const SurfaceAround around{&sites, &to_other(), &from_other(), sites.topology.edge_faces(edge), {a, b}};
  const EdgeContacts::Edge in_other{start, end, a_touches, b_touches, spokes_, around};
  const std::span<const EdgeContacts::Found> found =
      edge_contacts_.find(in_other, other(), query().limit, max_depth, tolerance());
  const bool may_be_deep = other().solid() && norm(end - start) > kLongEdge * query().size;
  Feature on_part{.key = kEdge | edge, .site = edge, .edge = true, .faces = faces};
  for (const EdgeContacts::InContact& part : edge_contacts_.in_contact()) {
    const std::size_t first = features_.size();
    for (std::uint32_t i = part.first_found; i < part.end_found; ++i) {
      Feature& feature = features_.emplace_back(on_part);
      feature.point.at = start + found[i].t * (end - start);
      if (found[i].support.face == kNone) {
        feature.point = measure_near(other(), feature.point.at, found[i].near_face);
        continue;
      }
      feature.key = (kEdge | kSupported | edge) + found[i].number * kNextOnEdge;
      if (found[i].way_out.place == WayOut::Place::beside) {
        feature.point = found[i].way_out.point;
        feature.own_face = found[i].way_out.own_face;
      } else
        feature.support = found[i].support;
    }
    if (may_be_deep) deepen(in_other, part, first, on_part);
    on_part.key += kNextOnEdge;
  }
  // An edge without a point near the surface is inside as a whole if its ends are.
  if (may_be_deep && edge_contacts_.in_contact().empty() && a_touches && b_touches)
    deepen(in_other, whole_edge(), features_.size(), on_part);
}

EdgeContacts::InContact FeatureContacts::whole_edge() const {
  return {{0, 1}, true, true, 0, 0, face_};
}

// Edges that are inside as a whole, in a region, beside a face that is not near: find_at_edges() omits them.
// Where a region is deep, the ends of its edges are deep enough.
void FeatureContacts::find_inside_edges(const ContactRegion& region) {
  if (!other().solid() || region.kind == ContactRegion::Kind::deep) return;
  const sites::SitesData& sites = internals(on().sites());
  const double shortest = kLongEdge * query().size;
  const double unit = shortest / to_other().scale * sites.frame.scale;
  const auto is_short = [&](const tree::FloatBox& box) {
    return norm(Vec3{box.upper[0] - box.lower[0], box.upper[1] - box.lower[1],
                     box.upper[2] - box.lower[2]}) <= unit;
  };
  if (is_short(sites.tree.box(region.source))) return;
  OneSidedVertices& vertices = candidates_->vertices();
  for (std::uint32_t leaf = region.first_leaf; leaf < region.last_leaf; ++leaf) {
    const std::uint32_t near = candidates_->near_faces(leaf), first = sites.regions.leaves[leaf];
    for (std::uint32_t place = first; place < sites.regions.leaves[leaf + 1]; ++place) {
      if ((near >> (place - first) & 1) != 0) continue;
      const std::uint32_t face = sites.regions.owners[place].face;
      bool known_inside = region.is_inside();
      for (const std::uint32_t edge : sites.topology.face_edges[face]) {
        if (edge == kNone || sites.topology.edge_faces(edge)[0] != face) continue;
        const auto [a, b] = sites.topology.edges[edge];
        const double length = to_other().scale * norm(sites.mesh.positions[b] - sites.mesh.positions[a]);
        if (length <= shortest || !is_sharp(sites, edge)) continue;
        // The corners of a face that is not near are on the same side.
        if (!known_inside && !vertices.in_contact(sites.regions.places.corners[place][0], face_)) break;
        known_inside = true;
        find_on_inside_edge(edge);
      }
    }
  }
}

void FeatureContacts::find_on_inside_edge(std::uint32_t edge) {
  const sites::SitesData& sites = internals(on().sites());
  const auto [a, b] = sites.topology.edges[edge];
  Feature feature{.key = kEdge | edge, .site = edge, .edge = true};
  for (const std::uint32_t beside : sites.topology.edge_faces(edge))
    for (const std::uint32_t corner : sites.mesh.triangles[beside])
      extend(feature.faces, sites.mesh.positions[corner]);
  const EdgeContacts::Edge in_other{.a = to_other().map(sites.mesh.positions[a]),
                                    .b = to_other().map(sites.mesh.positions[b])};
  deepen(in_other, whole_edge(), features_.size(), feature);
}

// The contacts of a part of an edge inside, at its ends, where faces support it and at its middle, may all be
// much shallower than a point between them: that has a contact then, in place of the middle.
void FeatureContacts::deepen(const EdgeContacts::Edge& edge, const EdgeContacts::InContact& part,
                             std::size_t first, const Feature& feature) {
  const Vec3 along = edge.b - edge.a;
  EdgeInside line{edge.a + part.from * along, edge.a + part.to * along};
  const double rest = kDeeper * norm(along);
  double known = 0;
  Feature* middle = nullptr;
  for (Feature& found : std::span(features_).subspan(first)) {
    const bool supported = found.support.face != kNone;
    if (!supported && found.own_face == kNone) middle = &found;
    known = std::max(known, -(supported ? found.support.height : found.point.distance));
  }
  std::uint32_t near_face = part.near_face;
  if (near_face != kNone) {
    // The distance to a face is convex, and bounds depths.
    const auto from_face = [&](const Vec3& p) {
      return sites::closest_on_face(internals(other().sites()), near_face, p).distance;
    };
    line.from_depth = from_face(line.from);
    line.to_depth = from_face(line.to);
    const double most = std::max(line.from_depth, line.to_depth);
    if (!part.from_a) line.from_depth = 0;
    if (!part.to_b) line.to_depth = 0;
    if (std::min(most, most_between(line)) <= kMuchDeeper * known + rest) return;
  }
  const auto measure_end = [&](const Vec3& end, double& depth) {
    const SurfacePoint point = measure_near(other(), end, near_face);
    near_face = point.face;
    depth = std::max(0.0, -point.distance);
    known = std::max(known, depth);
  };
  if (part.from_a) measure_end(line.from, line.from_depth);
  if (part.to_b) measure_end(line.to, line.to_depth);
  const SurfacePoint deepest = deep_point(other(), line, kMuchDeeper * known + rest, near_face);
  if (deepest.face == kNone || !at_boundary(other(), deepest)) return;
  if (middle == nullptr) middle = &features_.emplace_back(feature);
  middle->point = deepest;
}

}  // namespace sdm::contacts
