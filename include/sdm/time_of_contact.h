/// When two bodies that move from one pose to another first come into contact.
///
/// Threads: the functions may be called concurrently, also with the same shapes.
#pragma once

#include <sdm/api.h>
#include <sdm/bounds.h>
#include <sdm/names.h>
#include <sdm/shape.h>
#include <sdm/transform.h>

#include <array>
#include <cstdint>
#include <optional>
#include <tuple>

namespace sdm {

/// A motion during the time from 0 to 1: the centre of the mesh's box moves along a straight line, and the
/// body turns about it with constant speed, about one axis, by at most 180°.
struct Motion {
  Transform from{}, to{};  ///< as ProximityQuery::set_pose; with the same scale, to 1e-5

  /// The pose at a time. Throws sdm::Error as set_pose does, and for different scales.
  [[nodiscard]] SDM_API Transform at(double time, const Shape& shape) const;
};

/// The first contact of a motion.
struct TimeOfContact {
  /// The bodies collide at `time`, or are at most the tolerance apart; or, with `bounded`, they may be about
  /// to: a motion that must be free of contact ends at `time` in either case.
  bool contact = false;
  /// The bodies do not touch before this: they are more than half of the tolerance apart. 1 without contact.
  double time = 1;
  /// Between the surfaces at `time`; exact.
  double separation = 0;
  /// bounded: free of contact until `time` for certain, but not decided beyond it. The bodies are
  /// `separation` apart then, more than the tolerance, and the next step that is safe is less than rounding
  /// resolves: the time itself, whose unit is 1e-16, or coordinates in space. Also where two faces took a
  /// million steps.
  Certainty certainty = Certainty::exact;
  /// A point of O1 and a point of O2 that are `separation` apart at `time`, in space, and a face that
  /// contains each.
  std::array<Vec3, 2> witness{};
  std::array<std::uint32_t, 2> faces{kNone, kNone};
  /// Unit vector along which moving O1 separates it from O2: (witness[0] − witness[1]) / separation, or the
  /// opposite where one body contains part of the other at time 0. Nothing if the surfaces intersect then.
  std::optional<Vec3> normal{};
};

template <>
inline constexpr std::tuple kFields<TimeOfContact>{
    Field{
        "contact", &TimeOfContact::contact,
        "Whether the bodies collide at ``time``, or are at most the tolerance apart; or, where ``certainty`` "
        "is 'bounded', may be about to: a motion that must be free of contact ends at ``time`` in either "
        "case."},
    Field{"time", &TimeOfContact::time,
          "In [0, 1]. The bodies do not touch before this: they are more than half of the tolerance apart. 1 "
          "without contact."},
    Field{"separation", &TimeOfContact::separation,
          "The smallest distance between the surfaces at ``time``, in units of space; exact."},
    Field{
        "certainty", &TimeOfContact::certainty,
        "'exact'; or 'bounded': free of contact until ``time`` for certain, but not decided beyond it, as "
        "the "
        "next step that is safe is less than what rounding resolves: of the time, whose unit is 1e-16, or of "
        "coordinates in space. The bodies are ``separation`` apart then, more than the tolerance."},
    Field{"witness", &TimeOfContact::witness,
          "A point of O1 and a point of O2 that are ``separation`` apart at ``time``, in space."},
    Field{"faces", &TimeOfContact::faces, "A face of O1 and one of O2 that contain these points."},
    Field{
        "normal", &TimeOfContact::normal,
        "Unit vector along which moving O1 separates it from O2: (witness[0] - witness[1]) / separation, or "
        "the opposite where one body contains part of the other at time 0; nothing if the surfaces intersect "
        "then."}};

/// Finds the first contact by controlled conservative advancement (Tang, Kim & Manocha 2009): two parts of
/// the bodies, nodes of their trees or faces, that a direction separates need at least the distance along it,
/// divided by the speed along it, to meet. Each pair of parts advances by itself, so bodies that slide along
/// each other take no more steps than those that are far apart. No contact is missed, however thin the bodies
/// and long the motions. Bodies that collide at first have contact at time 0.
///
/// `tolerance` > 0, in units of space; bodies that come closer than it, but not closer than its half, may
/// have contact or not. Where it is less than the rounding of coordinates, results are `bounded`.
///
/// Throws sdm::Error for any other tolerance, and as Motion::at does. Cost: two searches for the closest
/// faces, that of the pairs of nodes that come near each other before the contact, and of a box around the
/// faces of each of these nodes. Single-threaded.
[[nodiscard]] SDM_API TimeOfContact time_of_contact(const Shape& o1, const Motion& motion1, const Shape& o2,
                                                    const Motion& motion2, double tolerance);

}  // namespace sdm
