// Vertices that are on the same side of another body.
#pragma once

#include <cstdint>
#include <vector>

#include "bodies/contacts/surface_point.h"
#include "mesh/similarity.h"

namespace sdm::contacts {

/// The vertices of some faces of a body, joined across the faces that are not near the other body: all
/// vertices of a set are inside, or all are outside, and none is within the margin of the surface. The sides
/// are found from one vertex of each set. Vertices are numbered as in the regions of the sites. Reuses its
/// memory. After find_sides(), several threads may query it at once.
class OneSidedVertices {
 public:
  /// `to_other`: from the frame of `on` to that of `other`; must outlive the queries, as the bodies.
  void start(const shape::Body& on, const shape::Body& other, const mesh::Similarity& to_other,
             double margin);
  /// `near`: the face may be within the margin of the other body.
  void add_face(const Triangle& corners, bool near);
  /// Finds the sides of the sets. Required before the queries below.
  void find_sides();

  /// Whether the vertex of a face that was added is in contact: inside, or within the margin. `face`: of the
  /// other body, probably close, or kNone; if the vertex is measured, the closest one.
  [[nodiscard]] bool in_contact(std::uint32_t vertex, std::uint32_t& face);
  /// Whether find_sides() has found the vertex to be out of contact. It finds nothing about vertices all of
  /// whose faces may be near.
  [[nodiscard]] bool is_free(std::uint32_t vertex) const;
  /// The closest point, if find_sides() has found it for this vertex.
  [[nodiscard]] const SurfacePoint* measured(std::uint32_t vertex) const;
  /// Finds the closest point of a vertex; `face` as above.
  [[nodiscard]] SurfacePoint measure(std::uint32_t vertex, std::uint32_t& face);

 private:
  enum class Side : std::uint8_t { unknown, contact, free };
  struct Vertex {
    std::uint32_t parent = kNone;  ///< in the tree of its set; kNone: no face was added
    std::uint32_t measured = kNone;
    bool alone = true;          ///< all of its faces may be near: it is a set of its own
    Side side = Side::unknown;  ///< of the set, where it is the root; of a vertex alone, once it is measured
  };
  [[nodiscard]] std::uint32_t find(std::uint32_t vertex);
  [[nodiscard]] SurfacePoint closest_point(std::uint32_t vertex, std::uint32_t& face) const;
  [[nodiscard]] Side side_of(const SurfacePoint& point) const;
  [[nodiscard]] Vec3 at(std::uint32_t vertex) const;  ///< in the frame of the other body

  const shape::Body *on_ = nullptr, *other_ = nullptr;
  const mesh::Similarity* to_other_ = nullptr;
  double margin_ = 0, rounding_ = 0;
  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> added_;
  std::vector<SurfacePoint> points_;
};

}  // namespace sdm::contacts
