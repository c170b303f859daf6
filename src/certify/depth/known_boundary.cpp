#include "certify/depth/known_boundary.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "geometry/vec.h"

namespace sdm::depth {
namespace {

// Those that bound a triangle are chosen among so many parts of the boundary that were found last.
constexpr std::size_t kRecent = 32;

}  // namespace

std::optional<std::array<BoundaryPart, 2>> KnownBoundary::nearest(const Vec3& centre,
                                                                  std::span<const Near> besides,
                                                                  std::size_t seen) const {
  const std::size_t none = known_.size();
  std::array<std::size_t, 2> nearest{none, none};
  std::array<double, 2> squared;
  squared.fill(std::numeric_limits<double>::infinity());
  for (std::size_t i = none - std::min(none, kRecent); i < none; ++i) {
    const double s = squared_norm(known_[i].from - centre);
    const std::uint32_t face = known_[i].boundary.face;
    if (!(s < squared[1]) || (face != kNone && std::ranges::any_of(besides, [&](const Near& n) {
                                return n.boundary.face == face;
                              })))
      continue;
    squared[1] = s, nearest[1] = i;
    if (s < squared[0]) std::swap(squared[0], squared[1]), std::swap(nearest[0], nearest[1]);
  }
  const auto is_new = [&](std::size_t i) { return i < none && i >= seen; };
  if (!is_new(nearest[0]) && !is_new(nearest[1])) return {};
  if (nearest[1] == none) nearest[1] = nearest[0];
  return std::array{known_[nearest[0]].boundary, known_[nearest[1]].boundary};
}

}  // namespace sdm::depth
