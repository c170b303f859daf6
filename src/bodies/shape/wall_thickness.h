// How thick the walls of a solid are.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "bodies/shape/node_ball.h"
#include "bodies/shape/touching_balls.h"
#include "inside/inside.h"
#include "sites/sites_data.h"
#include "tree/visit.h"

namespace sdm::shape {

/// Bounds on the depth of the points inside a solid by the part of its surface that they are closest to, each
/// found on first use. Thread-safe; no bound depends on the order of calls.
class WallThickness {
 public:
  WallThickness(const sites::SitesData& solid, const inside::InsideTest& inside);
  ~WallThickness();
  WallThickness(const WallThickness&) = delete;
  WallThickness& operator=(const WallThickness&) = delete;

  /// Starts anew, for new positions. Reuses the memory.
  void forget();

  /// All points inside whose closest point of the surface is on this face are at most so far from it; often
  /// infinite where walls are not thin. Cost: some searches of the tree for the first call, constant for
  /// others.
  [[nodiscard]] double of_face(std::uint32_t face) const;
  /// Whether all points inside whose closest point is in a ball are at most `most` from it: parts of faces
  /// for which it does not hold as a whole are looked at. False if too many faces are in the ball.
  [[nodiscard]] bool is_within(const Ball& ball, double most) const;

 private:
  // The quarters of a face, 0 to 3, and those of quarter i, from 4 i + 4.
  static constexpr std::size_t kParts = 20;
  using Bound = std::atomic<double>;  // 0: not known
  using Bounds = std::array<Bound, kParts>;
  struct NearBall;

  [[nodiscard]] double of_subtree(tree::Subtree subtree) const;
  [[nodiscard]] bool is_within(tree::Subtree subtree, NearBall& near) const;
  [[nodiscard]] bool is_within(std::uint32_t face, const NearBall& near) const;
  [[nodiscard]] double find(std::uint32_t face, const Corners& at) const;
  [[nodiscard]] double find_in_column(const TouchedTriangle& triangle) const;
  [[nodiscard]] Bounds& parts_of(std::uint32_t face) const;

  const sites::SitesData* solid_;
  const inside::InsideTest* inside_;
  std::size_t count_, node_count_;
  std::unique_ptr<Bound[]> bounds_;  // of faces
  std::unique_ptr<Bound[]> nodes_;   // of nodes of the tree: the largest of their faces
  /// The bounds of the parts of faces, where they were asked for.
  std::unique_ptr<std::atomic<Bounds*>[]> parts_;
};

}  // namespace sdm::shape
