// Rays against the eight-wide tree over the faces of O2: boxes and discs in single precision exclude faces,
// eight at a time; the faces that remain are tested exactly, in double precision.
#pragma once

#include <sdm/rays.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/unit_frame.h"
#include "sites/sites_data.h"
#include "tree/visit.h"

namespace sdm::rays {

/// The ray from a point near O2 on: origin + s·direction with s = length·t − skipped, begin ≤ s ≤ end, for
/// all parameters t of the given ray at which it can meet O2.
///
/// `error` bounds the rounding of the origin, of s, and of the parameters of hits, which are rounded to 1e-11
/// of the distance (geometry/line_triangle.h). Boxes are enlarged by it on all sides, by means of two
/// origins, so that they contain every hit as it is rounded.
struct UnitRay {
  float origin[3], direction[3];
  float beyond_lo[3], before_hi[3];  ///< the origin + error, from which lower sides are seen, and − error
  float inverse[3];                  ///< of the direction, finite
  float begin, end, error;
  double length, skipped;

  /// Returns false if the ray cannot meet O2.
  [[nodiscard]] bool place(const Ray& ray, const UnitFrame& frame);
  /// Ends the ray at a hit, which stays in it, as do others at the same t.
  void end_at(double t);
};

/// Per-thread memory, reused between rays.
struct Scratch {
  std::vector<tree::OpenNode> stack;
  std::vector<std::uint32_t> nodes;
};

/// As sdm::first_hits, into `hits`, on the calling thread. Dispatches at run time to the best vector
/// instructions of the machine.
void first_hits(const sites::SitesData& sites, std::span<const Ray> rays, Scratch& scratch, RayHit* hits);

/// Which faces a ray may hit: accepts(data, number of the ray, face).
struct FaceFilter {
  bool (*accepts)(const void* data, std::size_t ray, std::uint32_t face);
  const void* data;
};
/// The filter of a function (number of the ray, face) → bool, which must outlive it.
template <class Accepts>
[[nodiscard]] FaceFilter filter(const Accepts& accepts) {
  return {[](const void* data, std::size_t ray, std::uint32_t face) {
            return (*static_cast<const Accepts*>(data))(ray, face);
          },
          &accepts};
}
/// The first hits of faces that the filter accepts.
void first_hits(const sites::SitesData& sites, std::span<const Ray> rays, const FaceFilter& filter,
                Scratch& scratch, RayHit* hits);

/// What to do with a face: visit(data, face), whether to end there.
struct FaceVisitor {
  bool (*visit)(const void* data, std::uint32_t face);
  const void* data;
};
/// The visitor of a function (face) → bool, which must outlive it.
template <class Visit>
[[nodiscard]] FaceVisitor visitor(const Visit& visit) {
  return {[](const void* data, std::uint32_t face) { return (*static_cast<const Visit*>(data))(face); },
          &visit};
}
/// The nodes and leaves of the wide tree that meet a box, as children of nodes of their own: where searches
/// begin for several segments in the box.
struct NearNodes {
  std::vector<tree::WideTree::Node> nodes, next;
};
/// Sets `near` to the lowest nodes that are few. The box is in the unit frame.
void find_near_nodes(const sites::SitesData& sites, const tree::FloatBox& box, NearNodes& near);

/// The part of the segment from p to q between two parameters.
struct Segment {
  Vec3 p, q;
  double first = 0, last = 1;
};
/// Visits all faces that the segment meets, and some that it does not meet. `near`: of a box in which it
/// lies, or null.
void visit_faces_on_segment(const sites::SitesData& sites, const Segment& segment, const NearNodes* near,
                            const FaceVisitor& visitor, Scratch& scratch);

/// As sdm::occluded.
void occluded(const sites::SitesData& sites, std::span<const Ray> rays, Scratch& scratch,
              std::uint8_t* result);

}  // namespace sdm::rays
