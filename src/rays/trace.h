// Rays against the eight-wide tree over the faces of O2: boxes and discs in single precision exclude faces,
// eight at a time; the faces that remain are tested exactly, in double precision.
#pragma once

#include <sdm/rays.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sites/sites_data.h"
#include "tree/visit.h"

namespace sdm::rays {

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
