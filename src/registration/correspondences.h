// The closest points of samples, and the tangent planes of O2 there.
#pragma once

#include <sdm/align.h>
#include <sdm/sites.h>

#include <cstdint>
#include <vector>

#include "geometry/affine.h"
#include "registration/samples.h"

namespace sdm::registration {

/// O2, which of its vertices are on a boundary, and the part of it that counts.
struct Target {
  const Sites& sites;
  const AlignRegion* region = nullptr;          ///< null: all of it
  std::vector<std::uint8_t> boundary_vertices;  ///< empty if O2 is closed

  explicit Target(const Sites& o2);
};

/// One entry per sample.
struct Correspondences {
  std::vector<Vec3> points;       ///< the sample as it is placed
  std::vector<Vec3> closest;      ///< on O2
  std::vector<Vec3> normals;      ///< of the tangent plane, unit length: towards the sample, or of the face
  std::vector<double> distances;  ///< ≥ 0
  std::vector<std::uint32_t> faces;
  /// 0 for samples beside O2, on the other side of a wall, or with a closest point outside of the region;
  /// otherwise 1.
  std::vector<std::uint8_t> usable;
  std::vector<std::uint8_t> selected;  ///< 1 if the closest point is in the region; empty without one

  [[nodiscard]] bool is_selected(std::size_t i) const { return selected.empty() || selected[i] != 0; }
};

/// Finds the closest points of the samples, placed by `pose`. Cost: a search per sample, all cores.
[[nodiscard]] Correspondences find_correspondences(const Samples& samples, const Affine& pose,
                                                   const Target& target);

/// Returns at most `most` of the pairs in the region, of each direction of normals its share, in any order of
/// the samples: a rim is not missed because of its place in the mesh.
[[nodiscard]] Correspondences thinned(const Correspondences& pairs, std::size_t most);

/// The normals of the surface that the faces of O2 approximate, at the closest points: interpolated between
/// the corners of the face, where they are averages over the faces within 35° of it. On a polyhedron around
/// a sphere they are radial to second order, whereas those of its faces would determine its rotation.
[[nodiscard]] std::vector<Vec3> smooth_normals(const Correspondences& pairs, const Sites& sites);

}  // namespace sdm::registration
