// The deepest of some vertices inside a body.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/affine.h"
#include "mesh/similarity.h"
#include "proximity/contacts/surface_point.h"

namespace sdm::contacts {

/// Finds it with few searches for closest points: no vertex is deeper than its distance to any face, so that
/// only those are searched for that are farther from all faces found so far than the deepest one is deep.
/// Reuses its memory.
class DeepestVertex {
 public:
  /// Of vertices of `on`, numbered as in the regions of its sites, in `other`. `to_other`: from the frame of
  /// one to that of the other. All must outlive the search.
  void start(const shape::Body& on, const shape::Body& other, const mesh::Similarity& to_other);
  void add(std::uint32_t vertex);
  /// Adds a vertex whose closest point is known.
  void add(std::uint32_t vertex, const SurfacePoint& point);
  /// A face that is probably close to the vertices.
  void bound_by(std::uint32_t face);

  struct Found {
    std::uint32_t vertex = kNone;
    SurfacePoint point{};
  };
  /// The vertex with the smallest signed distance, of those whose distance is at most `margin`; of several at
  /// the same one, to rounding, any. Cost: linear for each search, of which there are a few.
  [[nodiscard]] Found find(double margin);

 private:
  void consider(std::uint32_t vertex, const SurfacePoint& point);
  [[nodiscard]] double exact_bound(const Vec3& at) const;

  const shape::Body *on_ = nullptr, *other_ = nullptr;
  const mesh::Similarity* to_other_ = nullptr;
  Affine from_unit_;     ///< from the unit frame of `on` to the frame of the other body
  double rounding_ = 0;  ///< of positions there
  Found best_;
  std::vector<std::uint32_t> vertices_;
  std::vector<double> x_, y_, z_;     ///< from single precision; in whole lanes, as are those below
  std::vector<double> bound_;         ///< of each vertex: no farther from the surface than this
  std::vector<std::uint32_t> faces_;  ///< that bound them
};

}  // namespace sdm::contacts
