// Pairs of faces, eight at a time: whose boxes overlap, and which a plane separates.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/triangle.h"
#include "sites/sites_data.h"

namespace sdm::inside {

using FacePair = std::array<std::uint32_t, 2>;

/// The boxes of faces in single precision, in the order of the leaves of the tree, all of them enlarged: two
/// that do not overlap are farther apart than twice the margin.
struct FaceBoxes {
  std::array<std::vector<float>, 3> lower, upper;

  /// `margin` in the unit frame, larger than the rounding there. Reuses the memory.
  /// Cost: linear, all cores.
  void set(const sites::SitesData& sites, double margin);
};

/// Appends the pairs of faces of two leaves of the tree whose boxes overlap; within one leaf each pair once.
void append_overlapping(const sites::SitesData& sites, const FaceBoxes& boxes, std::uint32_t leaf,
                        std::uint32_t other, std::vector<FacePair>& pairs);

/// Eight pairs of triangles, to be compared at once.
class TrianglePairs {
 public:
  static constexpr std::size_t kMost = 8;

  [[nodiscard]] bool full() const { return count_ == kMost; }
  [[nodiscard]] std::size_t size() const { return count_; }
  /// Only if not full.
  void add(const Corners& a, const Corners& b);
  void clear() { count_ = 0; }
  /// The bits of pairs for which a plane was found that keeps both triangles farther apart than `clearance`.
  /// The others may be nearer.
  [[nodiscard]] std::uint32_t apart(double clearance) const;

  // Corners relative to one of them, in units of the largest coordinate.
  alignas(64) float at[2][3][3][kMost] = {};  ///< of a triangle, a corner, a coordinate
  alignas(64) float unit[kMost] = {};         ///< rounded up

 private:
  std::size_t count_ = 0;
};

}  // namespace sdm::inside
