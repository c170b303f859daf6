#include "proximity/contacts/contact_finder.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>

#include "core/geometry/barycentric.h"
#include "core/geometry/sweep.h"
#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "engine/cpu/cpu_engine.h"
#include "proximity/shape/node_ball.h"
#include "sites/sites_data.h"

namespace sdm::contacts {
namespace {

using sites::SitesData;

// Edges with an end in contact have contacts between their ends only if they are longer than this part of the
// smaller body: of shorter ones, the end is near enough.
constexpr double kShortEdge = 1.0 / 16;
// How deep a face may be below the vertices and edges that it supports, relative to the smaller body.
constexpr double kSupportReach = 1.0 / 4;
// A corner at most this far, relative to the smaller body, from a face that cannot push it is flush with it.
constexpr double kFlush = 1.0 / 16;
// The sine of the angle by which all edges at a corner fall off behind its normal; 0.58 in a cube.
constexpr double kCorner = 0.25;
constexpr double kDirection = 1e-9;  // relative to the smaller body: the shortest vector with a direction
// The sine of the angle between faces below which their edge is flat: its points are in contact no sooner
// than those of the faces.
constexpr double kFlat = 1e-4;

// What a contact is of, in the upper bits of its number.
constexpr std::uint64_t kPart = std::uint64_t{1} << 60, kEdge = std::uint64_t{2} << 60;
constexpr int kBodyBit = 63, kOnEdgeBit = 32;  // of the number of a contact on an edge

// Whether the edge may be closer to another body than both faces beside it: if it is an edge of the boundary,
// or convex.
bool is_sharp(const SitesData& sites, std::uint32_t edge) {
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

Vec3 weights_in(const Mesh& mesh, std::uint32_t face, const Vec3& p) {
  const auto& [a, b, c] = mesh.triangles[face];
  return barycentric(mesh.positions[a], mesh.positions[b], mesh.positions[c], p);
}

}  // namespace

std::span<const Contact> ContactFinder::find(const Bodies& bodies,
                                             const std::array<mesh::Similarity, 2>& to_other, double margin,
                                             double length) {
  bodies_ = bodies, to_other_ = to_other, length_ = length;
  contacts_.clear(), boxes_.clear();
  for (body_ = 0; body_ < 2; ++body_) {
    limit_ = margin / bodies[1 - body_]->pose().scale;
    size_ = std::min(diagonal(other().box()), to_other_[body_].scale * diagonal(on().box()));
    find_leaves();
    find_vertices();
    find_edges();
    add_contacts();
  }
  return patches_.sort(contacts_, boxes_);
}

// The distance is 1-Lipschitz: a node in a ball whose centre is farther than its radius and the margin is not
// in contact.
void ContactFinder::find_leaves() {
  leaves_.clear();
  parts_.clear(), points_.clear();
  add_children(0);
  while (!parts_.empty()) {
    measure(0);
    std::swap(parts_, closer_);
    parts_.clear(), points_.clear();
    for (std::size_t i = 0; i < closer_.size(); ++i) {
      if (measured_[i].distance - closer_[i].radius > limit_) continue;
      if (hierarchy::WideTree::is_leaf(closer_[i].node))
        leaves_.push_back(hierarchy::WideTree::leaf_number(closer_[i].node));
      else
        add_children(closer_[i].node);
    }
  }
  std::ranges::sort(leaves_);
}

void ContactFinder::add_children(std::uint32_t node) {
  const SitesData& sites = internals(on().sites());
  const hierarchy::WideTree::Node& wide = sites.wide.nodes[node];
  for (std::uint32_t i = 0; i < wide.count; ++i) {
    const auto [centre, radius] = shape::ball_of_child(sites, node, i, to_other_[body_]);
    if (box_distance({centre, centre}, other().box()) > radius + limit_) continue;
    parts_.push_back({wide.child[i], radius});
    points_.push_back(centre);
  }
}

// Sets measured_ for points_ from `first` on.
void ContactFinder::measure(std::size_t first) {
  constexpr std::size_t kGrain = 512;
  const SitesData& sites = internals(other().sites());
  measured_.resize(points_.size());
  parallel_for(points_.size() - first, kGrain, [&](std::size_t begin, std::size_t end) {
    const std::span<const Vec3> points = std::span(points_).subspan(first + begin, end - begin);
    const auto take = [&](std::size_t offset, const sites::ClosestPacket& closest) {
      const std::uint32_t inside = other().inside()(points.subspan(offset, closest.count), closest);
      for (std::size_t i = 0; i < closest.count; ++i) {
        const bool in = (inside >> i & 1) != 0;
        const Vec3& p = points[offset + i];
        measured_[first + begin + offset + i] = {
            .distance = in ? -closest.distance[i] : closest.distance[i],
            .vector = {closest.vector[0][i], closest.vector[1][i], closest.vector[2][i]},
            .face = sites.face_of(closest.type[i], closest.site[i]),
            .at_boundary = !in || other().inside().at_boundary(p, closest.get(i, p))};
      }
    };
    cpu::cpu_search(sites, points, std::numeric_limits<double>::infinity(), std::ref(take));
  });
}

void ContactFinder::find_vertices() {
  const SitesData& sites = internals(on().sites());
  points_.clear(), vertices_.clear(), features_.clear();
  if (point_of_.size() < sites.mesh.positions.size()) point_of_.resize(sites.mesh.positions.size(), kNone);
  for (const std::uint32_t leaf : leaves_)
    for (std::uint32_t i = sites.regions.leaves[leaf]; i < sites.regions.leaves[leaf + 1]; ++i)
      for (const std::uint32_t vertex : sites.mesh.triangles[sites.regions.owners[i].face]) {
        if (point_of_[vertex] != kNone) continue;
        point_of_[vertex] = static_cast<std::uint32_t>(points_.size());
        vertices_.push_back(vertex);
        points_.push_back(to_other_[body_].map(sites.mesh.positions[vertex]));
      }
  measure(0);
  const std::span<const std::uint32_t> parts = on().contact_parts();
  for (std::uint32_t i = 0; i < vertices_.size(); ++i) {
    if (!(measured_[i].distance <= limit_)) continue;
    const std::uint32_t vertex = vertices_[i], part = parts[vertex];
    features_.push_back({.key = part == kNone ? vertex : kPart | part,
                         .distance = measured_[i].distance,
                         .point = i,
                         .site = vertex});
    if (part == kNone) support(features_.back());
  }
}

// A corner that is flush with a face that cannot push it is carried by another one.
void ContactFinder::support(Feature& feature) {
  const SitesData& sites = internals(on().sites());
  const Measured& closest = measured_[feature.point];
  const double distance = norm(closest.vector);
  if (!closest.at_boundary || distance > std::max(limit_, kFlush * size_)) return;
  // The direction of a vector within the rounding of points is that of the face.
  const Vec3 outwards = distance > kDirection * size_
                            ? (closest.distance < 0 ? 1 / distance : -1 / distance) * closest.vector
                            : internals(other().sites()).normals.face[closest.face];
  spokes_.clear();
  for (const std::uint32_t face : sites.vertex_faces.of(feature.site))
    for (const std::uint32_t corner : sites.mesh.triangles[face])
      if (corner != feature.site)
        spokes_.push_back(
            to_other_[body_].map.linear(sites.mesh.positions[corner] - sites.mesh.positions[feature.site]));
  if (can_push(outwards, spokes_)) return;
  // A vertex in a smooth surface has no other direction in which nothing else of the body is in contact
  // sooner.
  const Vec3 own = normalized(to_other_[body_].map.linear(sites.normals.vertex[feature.site]));
  for (const Vec3& spoke : spokes_)
    if (dot(own, spoke) > -kCorner * norm(spoke)) return;
  feature.support = support_of_vertex(other(), points_[feature.point], spokes_, limit_,
                                      std::max(limit_, kSupportReach * size_));
  if (feature.support.face != kNone) feature.distance = feature.support.height;
}

void ContactFinder::find_edges() {
  const SitesData& sites = internals(on().sites());
  const double shortest = kShortEdge * size_;
  const std::size_t first = points_.size(), first_feature = features_.size();
  for (const std::uint32_t leaf : leaves_)
    for (std::uint32_t i = sites.regions.leaves[leaf]; i < sites.regions.leaves[leaf + 1]; ++i) {
      const std::uint32_t face = sites.regions.owners[i].face;
      for (const std::uint32_t edge : sites.topology.face_edges[face]) {
        if (edge == kNone || sites.topology.edge_faces(edge)[0] != face) continue;
        const auto [a, b] = sites.topology.edges[edge];
        const std::uint32_t at_a = point_of_[a], at_b = point_of_[b];
        const double from_a = measured_[at_a].distance, from_b = measured_[at_b].distance;
        const bool a_touches = from_a <= limit_, b_touches = from_b <= limit_;
        const double length = norm(points_[at_b] - points_[at_a]);
        if (a_touches || b_touches ? length <= shortest : from_a + from_b - length > 2 * limit_) continue;
        if (!(length > 0) || !is_sharp(sites, edge)) continue;
        const Vec3 start = points_[at_a], along = points_[at_b] - start;
        spokes_.clear();
        for (const std::uint32_t beside : sites.topology.edge_faces(edge))
          for (const std::uint32_t corner : sites.mesh.triangles[beside])
            if (corner != a && corner != b)
              spokes_.push_back(
                  to_other_[body_].map.linear(sites.mesh.positions[corner] - sites.mesh.positions[a]));
        std::uint64_t number = 0;
        for (const auto& [t, support] :
             edge_contacts_.find({start, points_[at_b], a_touches, b_touches, spokes_}, other(), limit_,
                                 kSupportReach * size_)) {
          features_.push_back({.key = kEdge | number++ << kOnEdgeBit | edge,
                               .distance = support.height,
                               .point = static_cast<std::uint32_t>(points_.size()),
                               .site = edge,
                               .edge = true,
                               .support = support});
          points_.push_back(start + t * along);
        }
      }
    }
  for (const std::uint32_t vertex : vertices_) point_of_[vertex] = kNone;
  if (points_.size() == first) return;
  measure(first);
  for (Feature& feature : std::span(features_).subspan(first_feature))
    if (feature.support.face == kNone) feature.distance = measured_[feature.point].distance;
}

// Of each part, the deepest.
void ContactFinder::add_contacts() {
  const SitesData& sites = internals(on().sites());
  std::ranges::sort(features_, {}, [](const Feature& f) { return std::tuple(f.key, f.distance, f.site); });
  for (auto deepest = features_.begin(); deepest != features_.end();) {
    Box faces;
    auto next = deepest;
    for (; next != features_.end() && next->key == deepest->key; ++next)
      for (const std::uint32_t face :
           next->edge ? sites.topology.edge_faces(next->site) : sites.vertex_faces.of(next->site))
        for (const std::uint32_t corner : sites.mesh.triangles[face])
          extend(faces, sites.mesh.positions[corner]);
    add_contact(*deepest, faces);
    deepest = next;
  }
}

// `faces`: the box of the faces around it, in the frame of the body.
void ContactFinder::add_contact(const Feature& feature, const Box& faces) {
  const SitesData &sites = internals(on().sites()), &sites_of_other = internals(other().sites());
  const mesh::Similarity& pose = bodies_[1 - body_]->pose();  // in which points are measured
  const Vec3& p = points_[feature.point];
  Measured closest = measured_[feature.point];
  if (const Support& support = feature.support; support.face != kNone)
    closest = {.distance = support.height,
               .vector = -support.height * sites_of_other.normals.face[support.face],
               .face = support.face};
  const bool inside = closest.distance < 0;
  const Vec3 face_normal = sites_of_other.normals.face[closest.face];
  if (!closest.at_boundary) {
    other().require_boundary();
    const auto boundary = other().boundary().closest(p);
    if (boundary.point) closest.vector = *boundary.point - p, closest.face = boundary.face;
  }
  const double depth = pose.scale * (inside ? norm(closest.vector) : -closest.distance);
  const Vec3 vector = pose.map.linear(closest.vector), point = pose.map(p);
  const Vec3 outwards =
      std::abs(depth) > length_ ? (1 / depth) * vector : (1 / pose.scale) * pose.map.linear(face_normal);
  const std::uint32_t face =
      feature.edge ? sites.topology.edge_faces(feature.site)[0] : sites.vertex_faces.of(feature.site)[0];
  Contact contact{
      .point1 = point,
      .point2 = point + vector,
      .normal = body_ == 0 ? outwards : -outwards,
      .depth = depth,
      .faces = {face, closest.face},
      .barycentric = {weights_in(sites.mesh, face, to_other_[1 - body_].map(p)),
                      weights_in(sites_of_other.mesh, closest.face, p + closest.vector)},
      .id = std::uint64_t(body_) << kBodyBit | feature.key,
  };
  if (body_ == 1) {
    std::swap(contact.point1, contact.point2);
    std::swap(contact.faces[0], contact.faces[1]);
    std::swap(contact.barycentric[0], contact.barycentric[1]);
  }
  contacts_.push_back(contact);
  boxes_.push_back(image(bodies_[body_]->pose().map, faces));
  if (!inside) extend(boxes_.back(), point + vector);  // across the gap
}

}  // namespace sdm::contacts
