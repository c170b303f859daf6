#include "bodies/solids/solid_contacts.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "geometry/barycentric.h"
#include "geometry/triangle_pair.h"
#include "geometry/unit_across.h"

namespace sdm::solids {
namespace {

constexpr double kSame = 1e-6;  // of the size: points that are no farther apart are one
// Ids: those of vertices and of faces of meshes, which those of patches do not have.
constexpr std::uint64_t kOfVertex = std::uint64_t{1} << 60, kOfFace = std::uint64_t{1} << 59;

SurfacePoint surface_point(const shape::PosedBody& body, std::uint32_t face, const Vec3& p) {
  if (face == kNone) return {};
  const Mesh& mesh = internals(body.body().sites()).mesh;
  const auto& [a, b, c] = mesh.triangles[face];
  return {face,
          barycentric(mesh.positions[a], mesh.positions[b], mesh.positions[c], inverse(body.pose().map)(p))};
}

}  // namespace

std::span<const Contact> SolidContacts::find(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                             SolidPair& pair, double margin) {
  contacts_.clear();
  const Relation& relation = pair.relation();
  const double size = pair.size();
  const std::array bodies{&o1, &o2};
  if (relation.signed_distance && !(relation.gap <= margin)) return {};
  if (o1.body().has_support() && o2.body().has_support()) {
    for (const Contact& c : patch_.find(o1, o2, relation.normal, -relation.gap, size, kSame * size))
      if (c.depth >= -margin) contacts_.push_back(c);
    if (contacts_.empty()) add_single(o1, o2, pair);
  } else {
    const int mesh = o1.body().has_support() ? 1 : 0;
    const PosedCore core(*bodies[1 - mesh]);
    if (core.kind() == CoreKind::half_space)
      add_hull_of_vertices(*bodies[mesh], core, mesh, margin, size);
    else
      add_closest_faces(*bodies[mesh], core, mesh, pair, margin);
  }
  order_.sort(contacts_, kSame * size);
  return contacts_;
}

void SolidContacts::add_single(const shape::PosedBody& o1, const shape::PosedBody& o2, SolidPair& pair) {
  const Relation& relation = pair.relation();
  const std::array<std::uint32_t, 2> faces = pair.faces();
  Contact contact{.point1 = relation.point1, .point2 = relation.point2, .normal = relation.normal + Vec3{}};
  contact.depth = -relation.gap;
  contact.on = {surface_point(o1, faces[0], contact.point1), surface_point(o2, faces[1], contact.point2)};
  contacts_.push_back(contact);
}

void SolidContacts::add(const Vec3& on_mesh, std::uint32_t face, const shape::PosedBody& mesh,
                        const Vec3& on_solid, const Vec3& normal, double depth, int mesh_side,
                        std::uint64_t id) {
  Contact contact{.normal = (mesh_side == 0 ? normal : -normal) + Vec3{}, .depth = depth, .id = id};
  (mesh_side == 0 ? contact.point1 : contact.point2) = on_mesh;
  (mesh_side == 0 ? contact.point2 : contact.point1) = on_solid;
  contact.on[mesh_side] = surface_point(mesh, face, on_mesh);
  contacts_.push_back(contact);
}

void SolidContacts::add_hull_of_vertices(const shape::PosedBody& mesh, const PosedCore& space, int mesh_side,
                                         double margin, double size) {
  const sites::SitesData& sites = internals(mesh.body().sites());
  const Vec3& n = space.normal();
  const Vec3 x = unit_across(n), y = cross(n, x);
  std::vector<Corner>&places = places_, &hull = hull_;
  places.clear();
  hull.clear();
  for (std::uint32_t v = 0; v < sites.mesh.positions.size(); ++v) {
    if (sites.vertex_faces.of(v).empty()) continue;
    const Vec3 p = mesh.pose().map(sites.mesh.positions[v]);
    if (const double depth = space.offset() - dot(n, p); depth >= -margin)
      places.push_back({{dot(x, p), dot(y, p)}, depth, v});
  }
  if (places.empty()) return;
  const std::uint32_t deepest = std::ranges::max_element(places, {}, &Corner::depth)->vertex;
  // The convex hull, by Andrew's monotone chain.
  std::ranges::sort(places, {}, [](const Corner& c) { return std::tuple(c.at[0], c.at[1], -c.depth); });
  const auto add_to_hull = [&](const Corner& corner, std::size_t first) {
    while (hull.size() > first + 1) {
      const Vec2 a = hull[hull.size() - 2].at, side = corner.at - a;
      if (cross(hull.back().at - a, side) > kSame * size * std::sqrt(dot(side, side))) break;
      hull.pop_back();
    }
    hull.push_back(corner);
  };
  for (const Corner& corner : places) add_to_hull(corner, 0);
  const std::size_t last = hull.size() - 1;
  for (std::size_t i = places.size() - 1; i-- > 0;) add_to_hull(places[i], last);
  if (std::ranges::find(hull, deepest, &Corner::vertex) == hull.end())
    hull.push_back(*std::ranges::find(places, deepest, &Corner::vertex));
  std::ranges::sort(hull, {}, &Corner::vertex);
  const auto again = std::ranges::unique(hull, {}, &Corner::vertex);
  hull.erase(again.begin(), again.end());
  for (const Corner& corner : hull) {
    const Vec3 p = mesh.pose().map(sites.mesh.positions[corner.vertex]);
    add(p, sites.vertex_faces.of(corner.vertex)[0], mesh, p + corner.depth * n, n, corner.depth, mesh_side,
        kOfVertex | corner.vertex);
  }
}

void SolidContacts::add_closest_faces(const shape::PosedBody& mesh, const PosedCore& core, int mesh_side,
                                      SolidPair& pair, double margin) {
  const Relation& relation = pair.relation();
  const double size = pair.size();
  const bool outside = relation.normal != Vec3{} && relation.gap > -core.radius();
  if (relation.normal != Vec3{} && !outside) {
    // The core is inside: the way out.
    const Vec3 normal = mesh_side == 0 ? relation.normal : -relation.normal;
    add(mesh_side == 0 ? relation.point1 : relation.point2, pair.faces()[mesh_side], mesh,
        mesh_side == 0 ? relation.point2 : relation.point1, normal, -relation.gap, mesh_side, 0);
    return;
  }
  if (core.kind() == CoreKind::axis && core.disc() == 0 && !core.point())
    for (const double end : {-1.0, 1.0})
      add_from(PosedCore(core.centre() + end * core.half()), end < 0 ? 1 : 2, mesh, core, mesh_side, margin,
               size);
  add_from(core, 0, mesh, core, mesh_side, margin, size);
}

// The points of faces within the margin that are closest to a core, or to an end of it, among those around
// them.
void SolidContacts::add_from(const PosedCore& at, std::uint64_t id, const shape::PosedBody& mesh,
                             const PosedCore& core, int mesh_side, double margin, double size) {
  const double radius = core.radius(), same = kSame * size;
  faces_within(mesh, at, radius + margin, near_);
  const sites::SitesData& sites = internals(mesh.body().sites());
  const auto find = [&](std::uint32_t face) {
    const auto found = std::ranges::lower_bound(near_, face, {}, &FaceDistance::face);
    return found != near_.end() && found->face == face ? &*found : nullptr;
  };
  // Whether a face that shares a vertex has a closer point next to this one.
  const auto is_lowest = [&](const FaceDistance& face) {
    for (const std::uint32_t vertex : sites.mesh.triangles[face.face])
      for (const std::uint32_t beside : sites.vertex_faces.of(vertex)) {
        const FaceDistance* other = beside == face.face ? nullptr : find(beside);
        if (other == nullptr || other->distance >= face.distance - same) continue;
        const auto& [a, b, c] = sites.mesh.triangles[beside];
        const auto posed = [&](std::uint32_t v) { return mesh.pose().map(sites.mesh.positions[v]); };
        const PointPair points =
            closest_or_common({posed(a), posed(b), posed(c)}, {face.point1, face.point1, face.point1});
        if (std::sqrt(points.squared) <= same) return false;
      }
    return true;
  };
  for (const FaceDistance& face : near_) {
    if (face.normal == Vec3{} || !is_lowest(face)) continue;
    const Vec3 on_solid = face.point2 + radius * face.normal;
    const auto near = [&](const Contact& c) {
      return norm((mesh_side == 0 ? c.point1 : c.point2) - face.point1) <= same &&
             norm((mesh_side == 0 ? c.point2 : c.point1) - on_solid) <= same;
    };
    if (std::ranges::any_of(contacts_, near)) continue;
    add(face.point1, face.face, mesh, on_solid, face.normal, radius - face.distance, mesh_side,
        kOfFace | id << 32 | face.face);
  }
}

}  // namespace sdm::solids
