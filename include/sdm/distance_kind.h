/// Which distance a map or a cloud states.
///
/// Threads: plain values.
#pragma once

#include <sdm/names.h>
#include <sdm/options.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sdm {

/// What the distance of a sample is measured to. Only `closest` is a distance of points: it is 1-Lipschitz
/// along O1, so that samples bound it everywhere. The others hold at the samples and are estimates between;
/// of `facing`, prove_tolerance() decides limits for every point.
enum class DistanceKind : std::uint8_t {
  closest,    ///< the closest point of O2
  facing,     ///< the closest point of the faces of O2 that face the same way as the sample
  along,      ///< the nearest point of O2 on a line through the sample
  thickness,  ///< of the wall below the sample, which is of the part itself
  self,       ///< the closest point of the faces that the sample's face does not exclude, of the same mesh
};

template <>
inline constexpr std::array kWords<DistanceKind>{"closest", "facing", "along", "thickness", "self"};

/// Whether the distance is 1-Lipschitz along O1, so that samples bound it everywhere; others may jump between
/// samples.
[[nodiscard]] constexpr bool is_lipschitz(DistanceKind kind) {
  return kind == DistanceKind::closest;
}

/// Whether a sample may have nothing that it is measured to, at any distance: no face that faces as it does,
/// or nothing that ends a wall.
[[nodiscard]] constexpr bool may_lack_match(DistanceKind kind) {
  return kind != DistanceKind::closest && kind != DistanceKind::self;
}

/// Whether the closest point may be on the other skin of a wall that is thinner than twice the distance.
[[nodiscard]] constexpr bool may_cross_walls(DistanceKind kind) {
  return kind == DistanceKind::closest;
}

/// Whether the vector of a sample leads to any point of a face, rather than to the closest one of its site.
[[nodiscard]] constexpr bool ends_anywhere(DistanceKind kind) {
  return kind == DistanceKind::along || kind == DistanceKind::thickness;
}

/// What was measured, for reports.
struct MeasuredDistance {
  DistanceKind kind = DistanceKind::closest;
  std::string text = "distance to the closest point";  ///< with the rule's numbers, such as an angle
  std::optional<double> facing{};       ///< of DistanceKind::facing: the angle in degrees, MapOptions::facing
  std::vector<GivenOption> settings{};  ///< the options of the measure
};

/// Whether prove_tolerance() decides limits for every point.
[[nodiscard]] inline bool is_provable(const MeasuredDistance& measured) {
  return measured.kind == DistanceKind::closest ||
         (measured.kind == DistanceKind::facing && measured.facing.has_value());
}

}  // namespace sdm
