/// Whether an aligned O1 fits O2 better mirrored, or at another scale.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/align.h>
#include <sdm/api.h>
#include <sdm/mesh.h>
#include <sdm/names.h>
#include <sdm/sites.h>

#include <optional>
#include <span>
#include <tuple>

namespace sdm {

/// The mirror image of O1 fits better. Both misfits are estimates: the mean distance of samples of the
/// aligned O1 to O2, each at most a tenth of the radius of gyration of O1, as a fraction of that radius.
struct MirroredFit {
  double misfit = 0;
  double misfit_as_given = 0;
};

template <>
inline constexpr std::tuple kFields<MirroredFit>{
    Field{"misfit", &MirroredFit::misfit,
          "The mean distance of samples of the mirror image to O2, as a fraction of the radius of gyration."},
    Field{"misfit_as_given", &MirroredFit::misfit_as_given, "The same of O1 as it is."}};

/// Places the mirror image of O1 on O2 by principal axes, and returns its misfit, if it is at most a quarter
/// of that of O1 as `found` aligned it, and of that of O1 itself where its principal axes agree with those of
/// O2. Nothing if O1 fits, to 0.2 % of its radius of gyration, or if 90 % of its samples do, with a trimmed
/// rms of 1 %. Needs most of the surface of O1. `found`: the alignment of O1, of any options. Errors as of
/// align(). Cost: linear in O1; if O1 does not fit, also linear
/// in O2, and that of aligning 256 samples from up to 4 poses, or 24 where principal axes are nearly
/// interchangeable.
[[nodiscard]] SDM_API std::optional<MirroredFit> find_mirrored(const Mesh& o1, const Sites& o2,
                                                               const Alignment& found);

/// The same for points.
[[nodiscard]] SDM_API std::optional<MirroredFit> find_mirrored(std::span<const Vec3> points,
                                                               std::span<const Vec3> normals, const Sites& o2,
                                                               const Alignment& found);

/// O1 times a factor fits better. All are estimates, of samples.
struct OtherScale {
  double factor = 1;
  double standard_error = 0;  ///< of the factor, if residuals are independent noise
  double residual = 0;        ///< rms distance of the samples, of which each counts at most as a trimmed one
  double residual_as_given = 0;  ///< the same of O1 as it is
};

template <>
inline constexpr std::tuple kFields<OtherScale>{
    Field{"factor", &OtherScale::factor, "The factor by which O1 fits best."},
    Field{"standard_error", &OtherScale::standard_error,
          "The standard error of the factor, if residuals are independent noise."},
    Field{"residual", &OtherScale::residual, "The rms distance of the samples of the scaled O1."},
    Field{"residual_as_given", &OtherScale::residual_as_given, "The same of O1 as it is."}};

/// Moves and scales the aligned O1, by at most a fifth, to minimise its distances to O2, and returns the
/// factor if it is significant: beyond five standard errors from 1, and at most half of the squared residuals
/// are left. Nothing if freedoms are locked, and if O2 does not determine the scale. `found`: the alignment
/// of O1. Errors as of align(). Cost: linear in O1, and up to 6 closest points of 1024 samples each.
[[nodiscard]] SDM_API std::optional<OtherScale> find_scale(const Mesh& o1, const Sites& o2,
                                                           const Alignment& found);

/// The same for points.
[[nodiscard]] SDM_API std::optional<OtherScale> find_scale(std::span<const Vec3> points,
                                                           std::span<const Vec3> normals, const Sites& o2,
                                                           const Alignment& found);

}  // namespace sdm
