// Open meshes: their boundary, the faces that close them, and the winding numbers beside their faces.
#pragma once

#include <sdm/types.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "inside/angles/expansions.h"
#include "mesh/topology.h"
#include "sites/sites_data.h"

namespace sdm::inside {

/// Flags of the edges with one face, and of their vertices.
struct BoundarySites {
  std::vector<std::uint8_t> edges, vertices;

  BoundarySites() = default;
  BoundarySites(const mesh::Topology& topology, std::size_t vertex_count)
      : edges(topology.edges.size()), vertices(vertex_count) {
    for (std::size_t e = 0; e < edges.size(); ++e)
      if (topology.edge_faces(e).size() == 1)
        edges[e] = vertices[topology.edges[e][0]] = vertices[topology.edges[e][1]] = 1;
  }

  [[nodiscard]] bool contains(SiteType type, std::uint32_t site) const {
    return (type == SiteType::edge && edges[site] != 0) || (type == SiteType::vertex && vertices[site] != 0);
  }
};

/// The winding number of the faces of a mesh and of those that close it is constant on the outer side of a
/// face that no other one of either kind meets or comes near, larger by 1 on its inner side, and passes to
/// neighbours across their common edge. It is found once for each face that is asked for, as FaceSides finds
/// the sides of a solid, and then gives that of any point whose closest point is known: no face of the mesh
/// lies between the two, so only the crossings of closing faces are added. Thread-safe; answers do not depend
/// on the order of calls.
class OpenSides {
 public:
  /// Both must outlive this object and not change. No number is known if the mesh is not orientable.
  OpenSides(const sites::SitesData& sites, const OrientedFaces& closing);

  /// The winding number around q; empty if it is not constant beside the closest site, if that lies on the
  /// boundary, or if the site is no face and q is so near that rounding could decide. `direct(point)` finds a
  /// number without this. With `few`, also empty for the first points at each face, whose number would cost
  /// more than theirs.
  template <class Direct>
  [[nodiscard]] std::optional<int> operator()(const Vec3& q, const ClosestPoint& closest, bool few,
                                              const Direct& direct) const;

 private:
  /// Larger than kMost are no numbers. Those from kAskedOften to kUnknown are not known, and tell how often
  /// they were asked for.
  enum Number : std::int8_t { kMost = 100, kMixed = 120, kAskedOften = 122, kUnknown = 127 };

  template <class Direct>
  [[nodiscard]] std::int8_t of_face(std::uint32_t face, const Direct& direct) const;
  template <class Direct>
  [[nodiscard]] std::int8_t of_site(SiteType type, std::uint32_t site, const Direct& direct) const;
  [[nodiscard]] std::int8_t known_to_neighbour(std::uint32_t face) const;
  /// Whether no other face meets this one or comes near.
  [[nodiscard]] bool clear(std::uint32_t face) const;
  [[nodiscard]] bool is_fan(SiteType type, std::uint32_t site) const;
  /// A point on the outer side of a face, so near that no other face lies between them.
  [[nodiscard]] Vec3 beside(std::uint32_t face) const;
  [[nodiscard]] bool outside(const Vec3& q, const ClosestPoint& closest) const;
  /// The number of signed crossings of a segment that leads from q to a point beside the closest one.
  [[nodiscard]] std::optional<int> crossings_of_closing(const Vec3& q, const ClosestPoint& closest) const;
  [[nodiscard]] std::span<const std::uint32_t> faces_of(SiteType type, const std::uint32_t& site) const;

  const sites::SitesData& sites_;
  OrientedFaces closing_;
  BoundarySites boundary_;
  double offset_ = 0, clearance_ = 0;
  std::unique_ptr<std::atomic<std::int8_t>[]> outer_;  ///< none if the mesh is not orientable
};

template <class Direct>
std::optional<int> OpenSides::operator()(const Vec3& q, const ClosestPoint& closest, bool few,
                                         const Direct& direct) const {
  if (!outer_ || closest.type == SiteType::none || boundary_.contains(closest.type, closest.site)) return {};
  const bool near = closest.distance <= clearance_;
  if (near && closest.type != SiteType::face) return {};
  if (few) {
    std::int8_t number = outer_[closest.face].load(std::memory_order_relaxed);
    if (number > kAskedOften) {  // a lost race leaves it as it is, or as another thread found it
      outer_[closest.face].compare_exchange_strong(number, static_cast<std::int8_t>(number - 1),
                                                   std::memory_order_relaxed);
      return {};
    }
  }
  const std::int8_t outer = of_site(closest.type, closest.site, direct);
  if (outer > kMost) return {};
  const std::optional<int> turns = near ? 0 : crossings_of_closing(q, closest);
  return turns ? std::optional(outer + *turns + (outside(q, closest) ? 0 : 1)) : std::nullopt;
}

template <class Direct>
std::int8_t OpenSides::of_face(std::uint32_t face, const Direct& direct) const {
  std::int8_t number = outer_[face].load(std::memory_order_relaxed);
  if (number <= kMixed) return number;
  number = kMixed;
  if (clear(face)) {
    number = known_to_neighbour(face);
    if (number > kMost)
      if (const std::optional<int> found = direct(beside(face)); found && std::abs(*found) <= kMost)
        number = static_cast<std::int8_t>(*found);
  }
  outer_[face].store(number, std::memory_order_relaxed);
  return number;
}

template <class Direct>
std::int8_t OpenSides::of_site(SiteType type, std::uint32_t site, const Direct& direct) const {
  const std::span<const std::uint32_t> faces = faces_of(type, site);
  const std::int8_t first = of_face(faces.front(), direct);
  for (const std::uint32_t face : faces.subspan(1))
    if (first > kMost || of_face(face, direct) != first) return kMixed;
  return first > kMost || !is_fan(type, site) ? std::int8_t{kMixed} : first;
}

/// Triangles with the corners of the mesh that, together with its faces as they are oriented, form a closed
/// surface: each edge is passed as often in one direction as in the other, where vertices at the same
/// position are one. Their number is that of the boundary edges, counted by how often each is passed more in
/// one direction, less at least one for each loop of them. None if they are more than `most`.
/// Cost: O(n), plus O(b log b) for b boundary edges.
[[nodiscard]] std::optional<std::vector<Triangle>> closing_faces(const sites::SitesData& sites,
                                                                 std::size_t most);

}  // namespace sdm::inside
