// How thick the walls of a solid are.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "geometry/triangle_pair.h"
#include "query/inside/inside.h"
#include "query/shape/node_ball.h"
#include "sites/sites_data.h"

namespace sdm::shape {

/// Bounds on the balls inside a solid that touch its faces, each found on first use. Thread-safe; whether a
/// bound is at most some length does not depend on the order of calls.
class WallThickness {
 public:
  WallThickness(const sites::SitesData& solid, const inside::InsideTest& inside);
  ~WallThickness();
  WallThickness(const WallThickness&) = delete;
  WallThickness& operator=(const WallThickness&) = delete;

  /// Starts anew, for new positions. Reuses the memory.
  void forget();

  /// Whether all points inside whose closest point of the surface is on this face are at most `most` from
  /// it. May be false also for some faces for which this is so, at the ends of walls and where others meet.
  /// Cost: some searches of the tree for the first call with so large a `most`, constant for others.
  [[nodiscard]] bool is_within(std::uint32_t face, double most) const;
  /// The same for those whose closest point is in a ball: parts of a face for which it does not hold as a
  /// whole are looked at.
  [[nodiscard]] bool is_within(std::uint32_t face, const Ball& near, double most) const;

 private:
  // The quarters of a face, 0 to 3, and those of quarter i, from 4 i + 4.
  static constexpr std::size_t kParts = 20;
  using Bounds = std::array<std::atomic<double>, kParts>;  // negative: more than that

  [[nodiscard]] double find(std::uint32_t face, const Corners& at, double most) const;
  template <class Find>
  [[nodiscard]] static bool compare(std::atomic<double>& bound, double most, const Find& find);
  [[nodiscard]] Bounds& parts_of(std::uint32_t face) const;

  const sites::SitesData* solid_;
  const inside::InsideTest* inside_;
  std::size_t count_;
  std::unique_ptr<std::atomic<double>[]> bounds_;  // of faces
  /// Of the parts of faces, where they were asked for.
  std::unique_ptr<std::atomic<Bounds*>[]> parts_;
};

}  // namespace sdm::shape
