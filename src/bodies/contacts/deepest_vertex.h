// The deepest of some vertices inside a body.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bodies/contacts/surface_point.h"
#include "mesh/similarity.h"

namespace sdm::contacts {

/// Finds the deepest vertex with few searches for closest points: no vertex is deeper than its distance to
/// any face, so that only those are searched for that are farther from all faces found so far than the
/// deepest one is deep. Memory is reused.
class DeepestVertex {
 public:
  /// Starts with no vertex of `on`, numbered as in the regions of its sites; depths are in `other`.
  /// `to_other`, `from_other`: from the frame of one to that of the other, and back. Bodies and `to_other`
  /// must outlive the search.
  void start(const shape::Body& on, const shape::Body& other, const mesh::Similarity& to_other,
             const mesh::Similarity& from_other);
  /// A face, or kNone, that is probably close to the vertices added from here on. Required before the first
  /// one.
  void start_group(std::uint32_t face);
  /// Adds the vertices first ... last − 1.
  void add(std::uint32_t first, std::uint32_t last);
  /// Adds a vertex whose closest point is known.
  void add(std::uint32_t vertex, const SurfacePoint& point);

  struct Found {
    std::uint32_t vertex = kNone;
    SurfacePoint point{};
  };
  /// The vertex with the smallest signed distance, of those whose distance is at most `margin`; of several at
  /// the same one, to rounding, any. Cost: linear for each search, of which there are a few.
  [[nodiscard]] Found find(double margin);

  /// A face in single precision, for the vector code, in the unit frame of `on`.
  struct UnitTriangle {
    float corner[3][3] = {};
    bool flat = true;  ///< whether its normal is reliable
  };
  struct Rows {
    std::array<const float*, 3> at;
    float* bound;
  };
  static constexpr std::size_t kLanes = 8;

 private:
  struct Group {
    std::uint32_t first, face;
  };
  void consider(std::uint32_t vertex, const SurfacePoint& point);
  [[nodiscard]] UnitTriangle unit_triangle(std::uint32_t face);
  void bound(std::uint32_t face, std::size_t first, std::size_t last);
  [[nodiscard]] double exact_bound(const Vec3& at, std::size_t i) const;

  const shape::Body *on_ = nullptr, *other_ = nullptr;
  const mesh::Similarity* to_other_ = nullptr;
  mesh::Similarity to_unit_;  ///< from the frame of the other body to the unit frame of `on`
  float rounding_ = 0;        ///< of bounds
  Found best_;
  std::vector<std::uint32_t> vertices_;
  std::array<std::vector<float>, 3> at_;  ///< coordinates, in the unit frame
  std::vector<float> bound_;              ///< of each vertex: no farther from the surface than this
  std::vector<Group> groups_;
  std::vector<std::uint32_t> faces_;  ///< found
};

}  // namespace sdm::contacts
