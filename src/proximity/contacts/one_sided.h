// Vertices that are on the same side of another body.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/similarity.h"
#include "proximity/contacts/surface_point.h"

namespace sdm::contacts {

/// The vertices of some faces of a body, joined across the faces that are not near the other body: all
/// vertices of a set are inside, or all are outside, and none is within the margin of the surface. The sides
/// are found from one vertex of each set. Vertices are numbered as in the regions of the sites. Reuses its
/// memory.
class OneSidedVertices {
 public:
  /// `to_other`: from the frame of `on` to that of `other`; must outlive the queries, as the bodies.
  void start(const shape::Body& on, const shape::Body& other, const mesh::Similarity& to_other,
             double margin);
  /// `near`: the face may be within the margin of the other body.
  void add_face(const Triangle& corners, bool near);

  /// Whether a face of the vertex is not near the other body, so that the side of other vertices may be known
  /// from this one.
  [[nodiscard]] bool is_joined(std::uint32_t vertex) const { return !vertices_[vertex].alone; }
  /// Whether the vertex of a face that was added is in contact: inside, or within the margin.
  [[nodiscard]] bool in_contact(std::uint32_t vertex);
  /// What is known without a search.
  enum class Side : std::uint8_t { unknown, contact, free };
  [[nodiscard]] Side known_side(std::uint32_t vertex);
  /// The closest point, if a search has found it for this vertex.
  [[nodiscard]] const SurfacePoint* measured(std::uint32_t vertex) const;
  /// Finds the closest point of a vertex.
  [[nodiscard]] SurfacePoint measure(std::uint32_t vertex);

 private:
  struct Vertex {
    std::uint32_t parent = kNone;  ///< in the tree of its set; kNone: no face was added
    std::uint32_t measured = kNone;
    bool alone = true;          ///< all of its faces may be near: it is a set of its own
    Side side = Side::unknown;  ///< of the set, where it is the root
  };
  [[nodiscard]] std::uint32_t find(std::uint32_t vertex);
  [[nodiscard]] Vec3 at(std::uint32_t vertex) const;  ///< in the frame of the other body

  const shape::Body *on_ = nullptr, *other_ = nullptr;
  const mesh::Similarity* to_other_ = nullptr;
  double margin_ = 0, rounding_ = 0;
  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> added_;
  std::vector<SurfacePoint> points_;
  std::uint32_t face_ = kNone;  ///< closest to the vertex that was measured last
};

}  // namespace sdm::contacts
