// Winding numbers of points of solids, from one to the next.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "inside/shape_signs.h"
#include "rays/trace.h"
#include "sites/sites_data.h"

namespace sdm::inside {

/// Keeps the last points with their numbers, each with a ball around it that no face meets. The number of a
/// new point is that of the one whose ball is nearest to its own, and the crossings of the segment between
/// the two: of none if the balls overlap, otherwise of the part between them; or of the shortest way out of
/// the box, if that is shorter.
class WindingWalk {
 public:
  /// Prepares for points that are near each other: what is near to all of them is searched once.
  void approach(const ShapeSigns& signs, const sites::SitesData& solid, std::span<const Vec3> points);
  /// The number around a point from which no face is nearer than `clear` > 0. With `by_balls`, empty unless
  /// balls overlap, as long as this is rare.
  [[nodiscard]] std::optional<int> winding(const ShapeSigns& signs, const sites::SitesData& solid,
                                           const Vec3& point, double clear, bool by_balls);

 private:
  static constexpr std::size_t kKept = 16;

  void start(std::uint64_t shape);
  void keep(const Vec3& point, double clear, int number);

  std::uint64_t shape_ = 0;
  std::array<std::array<double, kKept>, 3> at_{};
  std::array<double, kKept> clear_{};  ///< −∞ where none is kept
  std::array<int, kKept> number_{};
  std::size_t next_ = 0;
  double overlapping_ = 1;  ///< the share of points whose balls overlap others, of the last ones
  Box near_box_;
  bool near_ = false;
  rays::NearNodes near_nodes_;
};

}  // namespace sdm::inside
