// Sums of the solid angles of many triangles at points near each other, compared with limits.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <span>

#include "inside/angles/solid_angles.h"

namespace sdm::inside {

/// Bits of the points of a packet whose side of the limit is known, and of those above it.
struct PacketSides {
  std::uint32_t known = 0, above = 0;
};

/// Compares the sums of the angles at `points`, at most kPacket, with a limit for each. One search of the
/// tree serves all of them: what is far from the packet is expanded about its centre, up to the first
/// derivative by the position of the point, and the faces that remain are evaluated at all points at once, in
/// single precision, with a bound on all errors. Few sides remain unknown if the packet is not larger than
/// what is around it; all of them do if too many faces are near, which costs less than a sum.
inline constexpr std::size_t kPacket = 16;
[[nodiscard]] PacketSides sides_of_packet(const SolidAngles& angles, std::span<const Vec3> points,
                                          std::span<const double> limits);

/// The side of all points that are nearer to `centre` than `radius`, in bit 0: known if the sums there are
/// all on one side of the limit by their expansions about the centre alone. No face may be as near as
/// `radius`, and the sides of few balls are known whose radius is more than a fifth of the distance to the
/// nearest.
[[nodiscard]] PacketSides side_of_ball(const SolidAngles& angles, const Vec3& centre, double radius,
                                       double limit);

}  // namespace sdm::inside
