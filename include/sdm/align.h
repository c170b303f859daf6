/// Rigid alignment of O1 to O2.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/execution.h>
#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/sites.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace sdm {

/// Where an alignment starts.
enum class AlignStart {
  /// The better of two starts: AlignOptions::pose and, if O1 fits poorly there and no freedom is locked, the
  /// pose in which the principal axes agree, which has to fit clearly better.
  automatic,
  pose,  ///< at AlignOptions::pose
  /// Where the centres and principal axes of both surfaces agree: the best of the 4 rotations that match
  /// axes, or of 24 if some axes are nearly interchangeable. Needs most of the surface of O1.
  principal_axes,
};

template <>
inline constexpr std::array kWords<AlignStart>{"automatic", "pose", "principal_axes"};

/// The motions that an alignment may use: x ↦ about + R (start(x) − about) + t. With the axes of O2's
/// coordinates, t has no component along an axis whose translation is locked, and the rotation vector of R
/// none along one whose rotation is. All are allowed by default.
struct AlignFreedoms {
  std::array<bool, 3> translations{true, true, true};  ///< along x, y and z
  std::array<bool, 3> rotations{true, true, true};     ///< about axes along x, y and z
  Vec3 about{};  ///< the point of these axes; without effect unless a translation or rotation is locked

  friend bool operator==(const AlignFreedoms&, const AlignFreedoms&) = default;

  /// Whether nothing is locked.
  [[nodiscard]] bool all() const {
    return translations == std::array{true, true, true} && rotations == std::array{true, true, true};
  }
};

/// Reads a list such as "xyz,rz": words, separated by commas, of x, y and z for translations along these
/// axes, or, after r, for rotations about them. All others are locked; `about` is the origin. Nothing for any
/// other text.
[[nodiscard]] SDM_API std::optional<AlignFreedoms> parse_freedoms(std::string_view text);

/// The letters of the freedoms that are not locked, such as "x", "y" and "rz".
[[nodiscard]] SDM_API std::vector<std::string> names_of(const AlignFreedoms& freedoms);

/// The motions as a list; `about` is an option of its own.
template <>
struct OptionForm<AlignFreedoms> {
  static constexpr const char* kType = "motions";
  static std::string needed() { return "a list of x, y, z, rx, ry and rz, such as xyz,rz"; }
  SDM_API static bool read(std::string_view text, const OptionRange& range, AlignFreedoms& value);
  SDM_API static std::string text(const AlignFreedoms& value);
  static bool allowed(const AlignFreedoms&, const OptionRange&) { return true; }
};

template <>
inline constexpr auto kOptions<AlignFreedoms> = std::tuple{
    Option{.name = "about",
           .member = &AlignFreedoms::about,
           .text = "The point that the axes of the rotations that are not locked go through; by default the "
                   "origin.",
           .range = {.least = -1e37, .most = 1e37},
           .value = "X,Y,Z"}};

/// The part of O2 that O1 is fitted to: faces and boxes together; all of O2 if there are none.
struct AlignRegion {
  std::vector<std::uint8_t> faces{};  ///< one entry for each face of O2, other than 0 if it belongs; or empty
  std::vector<Box> boxes{};           ///< whatever of O2 is within

  /// Whether it is all of O2.
  [[nodiscard]] bool whole() const { return faces.empty() && boxes.empty(); }
};

/// Options of align().
struct AlignOptions {
  AlignStart start = AlignStart::automatic;
  Transform pose{};             ///< rotation and translation; the identity: O1 as it is
  std::size_t samples = 32768;  ///< at least 64; of the last and finest level
  int max_iterations = 100;     ///< greater than 0; per level
  AlignFreedoms freedoms{};     ///< those locked stay as at `pose`
  AlignRegion region{};         ///< of the last level; the first, coarse one is of all of O2
  /// The number of the group of each face of O2, or kNone, for Alignment::groups; or empty.
  std::span<const std::uint32_t> group_of_face{};
  Progress progress{};
};

template <>
inline constexpr auto kOptions<AlignOptions> = std::tuple{
    Option{.name = "start",
           .member = &AlignOptions::start,
           .text =
               "Where the alignment starts: at the pose; where centres and principal axes of both agree, "
               "which needs most of the surface of O1; or, automatic, at the pose and, if that leads to a "
               "poor fit, also at the axes."},
    Option{.name = "samples",
           .member = &AlignOptions::samples,
           .text = "Samples of the surface of O1.",
           .range = {.least = 64},
           .value = "N"},
    Option{.name = "max_iterations",
           .member = &AlignOptions::max_iterations,
           .text = "Steps for each level of refinement.",
           .range = {.least = 1},
           .value = "N"},
    Option{.name = "free",
           .member = &AlignOptions::freedoms,
           .text = "The motions that the alignment may use, the others are locked: xyz,rz for translations "
                   "along x, y and z and a rotation about z, or any of x, y, z, rx, ry, rz; axes of O2's "
                   "coordinates.",
           .value = "MOTION,..."}};

/// A rigid motion, and how well O2 determines it at the aligned pose. Each is a translation and a rotation
/// about an axis through `centre`, which is moved by |rotation| radians times the radius of gyration of O1:
/// |translation|² + |rotation|² = 1.
struct DegreeOfFreedom {
  Vec3 translation{}, rotation{};
  /// The point of the axis that is closest to the centre of O1; nothing without a rotation.
  std::optional<Vec3> axis_point{};
  /// The rms distance along the normals of O2 by which the samples move, per unit of motion, in [0, √2]: 1
  /// for a plane that moves along its normal, 0 for one that moves in itself.
  double determined = 0;
  /// An estimate: the standard error of the motion, as a length, if residuals are independent noise.
  /// Nothing if free.
  std::optional<double> standard_error{};
  /// `determined` is below 0.02: O2 is nearly unchanged by this motion, so that O1 fits as well after it. How
  /// far the alignment moved O1 so is arbitrary.
  bool free = false;
  bool locked = false;  ///< AlignOptions::freedoms does not allow it; the alignment leaves it as at the start
};

template <>
inline constexpr std::tuple kFields<DegreeOfFreedom>{
    Field{"translation", &DegreeOfFreedom::translation, "The translation."},
    Field{"rotation", &DegreeOfFreedom::rotation, "Along the axis."},
    Field{"axis_point", &DegreeOfFreedom::axis_point,
          "The point of the axis that is closest to the centre of O1; nothing without a rotation."},
    Field{"determined", &DegreeOfFreedom::determined,
          "The rms distance by which the samples move along the normals of O2, per unit of motion: 0 for a "
          "plane that moves in itself, 1 for one that moves along its normal."},
    Field{"standard_error", &DegreeOfFreedom::standard_error,
          "An estimate: the standard error of the motion, as a length, if residuals are independent noise; "
          "nothing if it is free."},
    Field{"free", &DegreeOfFreedom::free, "O2 is nearly unchanged by the motion: O1 fits as well after it."},
    Field{"locked", &DegreeOfFreedom::locked, "The alignment was not allowed to use it."}};

/// Distances of the samples to O2, in units of the meshes; NaN if there are none.
struct AlignResiduals {
  double rms = 0;          ///< of all samples
  double trimmed_rms = 0;  ///< of the smallest ones, `fraction_used` of all
};

template <>
inline constexpr std::tuple kFields<AlignResiduals>{
    Field{"rms", &AlignResiduals::rms, "The rms distance of the samples to O2."},
    Field{"trimmed_rms", &AlignResiduals::trimmed_rms,
          "The same of the samples with the smallest distances."}};

/// Distances of the samples whose closest point is on a group of faces of O2.
struct GroupResiduals {
  std::size_t samples = 0;
  double rms = 0, largest = 0;  ///< in units of the meshes; 0 without samples
};

template <>
inline constexpr std::tuple kFields<GroupResiduals>{
    Field{"samples", &GroupResiduals::samples, "The number of samples."},
    Field{"rms", &GroupResiduals::rms, "Their rms distance to O2."},
    Field{"largest", &GroupResiduals::largest, "Their largest one."}};

/// A rigid motion that aligns O1 to O2, and how good it is. With a region, samples are those whose closest
/// point is in it.
struct Alignment {
  /// Maps O1, as it was given, to its place on O2: a rotation and a translation.
  Transform transform;
  AlignResiduals before;  ///< of O1 as it was given; of 1024 samples
  AlignResiduals after;
  std::size_t samples = 0;
  double fraction_used = 0;  ///< of the samples, in the last step; the others are taken for outliers
  /// The fraction of the samples that were used or lie within 1e-5 of the radius of gyration of O2, since
  /// rounding of coordinates makes no outliers.
  double fraction_fitting = 0;
  int iterations = 0;          ///< of all levels
  bool converged = false;      ///< the last step moved O1 by less than 1e-6 of its radius of gyration
  Vec3 centre{};               ///< of O1, aligned: the median of its samples along each axis
  double gyration_radius = 0;  ///< of O1 about its centre
  std::array<DegreeOfFreedom, 6> freedoms{};  ///< the best determined one first; orthonormal unless free;
                                              ///< locked ones come last
  std::vector<GroupResiduals> groups{};       ///< by AlignOptions::group_of_face, of all samples
};

template <>
inline constexpr std::tuple kFields<Alignment>{
    Field{"transform", &Alignment::transform,
          "Maps O1, as it was given, to its place on O2: a rotation and a translation, for column vectors."},
    Field{"converged", &Alignment::converged,
          "The last step moved O1 by less than 1e-6 of its radius of gyration."},
    Field{"iterations", &Alignment::iterations, "Steps, of all levels."},
    Field{"samples", &Alignment::samples, "The number of samples."},
    Field{"fraction_used", &Alignment::fraction_used,
          "Of the samples, in the last step; the others are taken for outliers."},
    Field{"fraction_fitting", &Alignment::fraction_fitting,
          "Of the samples: those used, and those within 1e-5 of the radius of gyration of O2, since rounding "
          "of "
          "coordinates makes no outliers."},
    Field{"before", &Alignment::before, "Distances of samples of O1, as it was given, to O2."},
    Field{"after", &Alignment::after, "Those of the aligned samples."},
    Field{"centre", &Alignment::centre,
          "The centre of the aligned O1: the median of its samples along each axis."},
    Field{"gyration_radius", &Alignment::gyration_radius, "The radius of gyration of O1 about its centre."},
    Field{"freedoms", &Alignment::freedoms, "The six degrees of freedom, the best determined one first."}};

/// Finds the rotation and the translation that move the surface of `o1` onto O2, by iterated closest points:
/// each step minimises the squared distances of samples to the tangent planes of O2 at their closest points.
/// Samples are refined from 1024 to options.samples. Without weight are residuals above three times their
/// robust standard deviation (1.48 times the median), unless they are needed to determine the motion; samples
/// whose closest point is on the boundary of O2; and those whose normal differs from that of O2 by more than
/// 60°, if enough are left. On a copy of O2, or of a part of it, the steps converge quadratically to
/// rounding.
///
/// Finds a local optimum from some 20° and 10 % of the size, or keeps options.pose if that is closer; with
/// AlignStart::automatic, also one that the principal axes lead to. The result does not depend on the number
/// of threads. Throws sdm::Error when the mesh is unusable (see validate), for options out of range or of
/// another O2, if options.pose is not a rotation and a translation, if freedoms are locked and the start is
/// not a pose, if no sample is near the region, or if there is not enough memory; Cancelled. Cost: linear in
/// the faces of O1, and 10 to 30 closest points for each sample.
[[nodiscard]] SDM_API Alignment align(const Mesh& o1, const Sites& o2, const AlignOptions& options = {});

/// The same for points, of which a pseudorandom subset is used if there are more than options.samples.
/// `normals`: one for each point, of any length; or empty. Also throws sdm::Error for a coordinate that is
/// NaN or beyond 1e37, without points, and if the number of normals differs.
[[nodiscard]] SDM_API Alignment align(std::span<const Vec3> points, std::span<const Vec3> normals,
                                      const Sites& o2, const AlignOptions& options = {});

/// How far an alignment has moved O1.
struct AlignMotion {
  double rotation_degrees = 0;  ///< the angle of the rotation, in [0, 180]
  double translation = 0;       ///< of the centre of O1
};

template <>
inline constexpr std::tuple kFields<AlignMotion>{
    Field{"rotation_degrees", &AlignMotion::rotation_degrees, "The angle of the rotation."},
    Field{"translation", &AlignMotion::translation, "How far the centre of O1 moved."}};

/// Returns the sizes of the motion. Cost: O(1).
[[nodiscard]] SDM_API AlignMotion motion_of(const Alignment& alignment);

/// Returns the motion of a 3-2-1 alignment, in closed form: it moves the plane of the first three `points` of
/// O1, the primary ones, onto that of their `places` on O2; the line of the next two, the secondary ones,
/// onto that of theirs, both as seen along the normal of the plane; and the last, tertiary one as far along
/// this line as its place is. The normal is (p1 − p0) × (p2 − p0), and the line runs from p3 to p4. Use it as
/// AlignOptions::pose. Throws sdm::Error unless there are six of each, for coordinates that are NaN or beyond
/// 1e37, and if the primary points are on a line or the secondary ones on a normal of the plane. Cost: O(1).
[[nodiscard]] SDM_API Transform align_321(std::span<const Vec3> points, std::span<const Vec3> places);

}  // namespace sdm
