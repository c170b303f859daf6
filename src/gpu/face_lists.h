// The points that a device is given, and the faces that it finds for them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sdm::gpu {

/// Points that are searched for together, if they are near each other.
inline constexpr std::size_t kTilePoints = 64;

/// The faces that may be closest to a point, as the device writes them.
struct FaceList {
  static constexpr std::uint32_t kMost = 15;

  std::uint32_t head;
  std::uint32_t number[kMost];  ///< of the faces, in the order of the leaves

  [[nodiscard]] std::uint32_t count() const { return head & 15u; }
  /// Whether there may be others: there was no room for them.
  [[nodiscard]] bool incomplete() const { return (head & 16u) != 0; }
  /// Whether it was searched for alone, as the points beside it are too far from each other.
  [[nodiscard]] bool alone() const { return (head & 32u) != 0; }
  [[nodiscard]] std::uint32_t nodes() const { return head >> 6 & 0xfffu; }  ///< visited, at most 4095
  [[nodiscard]] std::uint32_t tests() const { return head >> 18; }          ///< faces compared, at most 16383
};

/// The lists of some points for each part of the sites (SitesOnDevice).
struct FaceLists {
  std::size_t points = 0;
  std::vector<std::uint32_t> first;  ///< of the faces of each part
  std::vector<FaceList> lists;       ///< those of all points for the first part, then for the next

  [[nodiscard]] const FaceList& of(std::size_t part, std::size_t point) const {
    return lists[points * part + point];
  }
};

/// A point in the unit frame, and nothing farther than `within` is closest; negative if there is nothing to
/// be found.
struct QueryPoint {
  float position[3];
  float within;
};
static_assert(sizeof(FaceList) == 64 && sizeof(QueryPoint) == 16);

}  // namespace sdm::gpu
