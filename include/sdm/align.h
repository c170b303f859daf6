/// Rigid alignment of O1 to O2.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>
#include <sdm/progress.h>
#include <sdm/sites.h>
#include <sdm/transform.h>

#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace sdm {

/// Where an alignment starts.
enum class AlignStart {
  pose,  ///< at AlignOptions::pose
  /// Where the centres and principal axes of both surfaces agree: the best of the 4 rotations that match
  /// axes, or of 24 if some axes are nearly interchangeable. Needs most of the surface of O1.
  principal_axes,
};

/// Options of align().
struct AlignOptions {
  AlignStart start = AlignStart::pose;
  Transform pose{};             ///< rotation and translation; the identity: O1 as it is
  std::size_t samples = 32768;  ///< at least 64; of the last and finest level
  int max_iterations = 100;     ///< greater than 0; per level
  Progress progress{};
};

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
  /// `determined` is below 0.02: O2 is nearly unchanged by this motion. The alignment leaves it as at the
  /// start.
  bool free = false;
};

/// Distances of the samples to O2, in units of the meshes.
struct AlignResiduals {
  double rms = 0;          ///< of all samples
  double trimmed_rms = 0;  ///< of the smallest ones, `fraction_used` of all
};

/// A rigid motion that aligns O1 to O2, and how good it is.
struct Alignment {
  /// Maps O1, as it was given, to its place on O2: a rotation and a translation.
  Transform transform;
  AlignResiduals before;  ///< of O1 as it was given; of 1024 samples
  AlignResiduals after;
  std::size_t samples = 0;
  double fraction_used = 0;    ///< of the samples, in the last step; the others are taken for outliers
  int iterations = 0;          ///< of all levels
  bool converged = false;      ///< the last step moved O1 by less than 1e-6 of its radius of gyration
  Vec3 centre{};               ///< of O1, aligned: the median of its samples along each axis
  double gyration_radius = 0;  ///< of O1 about its centre
  std::array<DegreeOfFreedom, 6> freedoms{};  ///< the best determined one first; orthonormal unless free
};

/// Finds the rotation and the translation that move the surface of `o1` onto O2, by iterated closest points:
/// each step minimises the squared distances of samples to the tangent planes of O2 at their closest points.
/// Samples are refined from 1024 to options.samples. Without weight are residuals above three times their
/// robust standard deviation (1.48 times the median), unless they are needed to determine the motion; samples
/// whose closest point is on the boundary of O2; and those whose normal differs from that of O2 by more than
/// 60°, if enough are left. On a copy of O2, or of a part of it, the steps converge quadratically to
/// rounding.
///
/// Finds a local optimum: the start should be within some 20° and 10 % of the size. The result does not
/// depend on the number of threads. Throws sdm::Error when the mesh is unusable (see validate), for options
/// out of range, if options.pose is not a rotation and a translation, or if there is not enough memory;
/// Cancelled. Cost: linear in the faces of O1, and 10 to 30 closest points for each sample.
[[nodiscard]] SDM_API Alignment align(const Mesh& o1, const Sites& o2, const AlignOptions& options = {});

/// The same for points, of which a pseudorandom subset is used if there are more than options.samples.
/// `normals`: one for each point, of any length; or empty. Also throws sdm::Error for a coordinate that is
/// NaN or beyond 1e37, without points, and if the number of normals differs.
[[nodiscard]] SDM_API Alignment align(std::span<const Vec3> points, std::span<const Vec3> normals,
                                      const Sites& o2, const AlignOptions& options = {});

}  // namespace sdm
