/// What withholds a PASS: signs that what was measured is not what was meant. How much of O2 was measured,
/// and whether O1 fits O2 better mirrored, at another scale, or in another unit of length.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/align.h>
#include <sdm/execution.h>
#include <sdm/mesh.h>
#include <sdm/names.h>
#include <sdm/sites.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

/// The share of the area of O2 whose distance to the measured surface is at most `reach`.
struct Coverage {
  double value = 0;             ///< in [0, 1]; an estimate within the bounds
  double lower = 0, upper = 1;  ///< certified
  double reach = 0;
};

template <>
inline constexpr std::tuple kFields<Coverage>{
    Field{"value", &Coverage::value, "In [0, 1]; an estimate within the bounds."},
    Field{"lower", &Coverage::lower, "Certified."}, Field{"upper", &Coverage::upper, "Certified."},
    Field{"reach", &Coverage::reach, "How near."}};

/// A part of a face of O2.
struct CoveragePiece {
  std::uint32_t face = 0;
  std::array<Vec3, 3> corners{};  ///< in the order of the face
  bool covered = false;
};

/// Where O2 is covered: as bounds say, and where these do not decide, as the centroids of faces and pieces.
struct CoverageMap : Coverage {
  std::vector<float> of_face{};  ///< of each face of O2, the covered share of its area; NaN without area
  std::vector<CoveragePiece> pieces{};  ///< those of the faces that are covered in part, by face
};

template <>
inline constexpr auto kFields<CoverageMap> = std::tuple_cat(
    kFields<Coverage>, std::tuple{Field{"of_face", &CoverageMap::of_face,
                                        "Of each face of O2, the share of its area: an estimate; NaN without "
                                        "area."}});

/// Options of coverage() and coverage_map().
struct CoverageOptions {
  double precision = 0.002;                        ///< ends as soon as the bounds are so close; ≥ 0
  std::size_t most_pieces = std::size_t{1} << 19;  ///< ends before so many pieces of O2 would be measured
  Progress progress{};
};

/// Returns how much of O2 has a point of the measured surface within `reach`. Faces of O2 are divided into
/// quarters where their centroids do not decide: as distances are 1-Lipschitz, a piece is within reach if the
/// distance of its centroid plus its radius is, and beyond if that distance minus the radius is; of other
/// pieces the centroid decides the value. The bounds are close if O2 is not much larger than the reach.
/// Throws sdm::Error if O2 is unusable (see validate), for a reach that is not positive, a precision that is
/// negative or NaN, and if there is not enough memory; Cancelled. Cost: a closest point for each piece, all
/// cores; at least as many as O2 has faces.
[[nodiscard]] SDM_API Coverage coverage(const Mesh& o2, const Sites& measured, double reach,
                                        const CoverageOptions& options = {});

/// The same for measured points. Also throws sdm::Error without points, and for a coordinate that is NaN or
/// infinite.
[[nodiscard]] SDM_API Coverage coverage(const Mesh& o2, std::span<const Vec3> measured, double reach,
                                        const CoverageOptions& options = {});

/// The same with the places, for pictures. Cost: that of coverage(), and memory for each piece.
[[nodiscard]] SDM_API CoverageMap coverage_map(const Mesh& o2, const Sites& measured, double reach,
                                               const CoverageOptions& options = {});
/// The same for measured points.
[[nodiscard]] SDM_API CoverageMap coverage_map(const Mesh& o2, std::span<const Vec3> measured, double reach,
                                               const CoverageOptions& options = {});

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
/// align(). Cost: linear in O1; if O1 does not fit, also linear in O2, and that of aligning 256 samples from
/// up to 4 poses, or 24 where principal axes are nearly interchangeable.
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

/// O1 times a ratio of two units fits better. Both misfits are estimates: the rms distance of samples of the
/// aligned O1 to O2, as a fraction of the radius of gyration of O1 at that size.
struct OtherUnit {
  double factor = 1;  ///< 10, 25.4, 304.8 or 1000, or the inverse of one
  double misfit = 0;
  double misfit_as_given = 0;
  bool same_box = false;  ///< of find_other_unit_in_place(): O1 has the box of O2 at that size
};

/// Aligns O1, times each ratio of two common units of length, to O2 as align() does with these options, and
/// returns the ratio whose misfit is the least, if it is at most a quarter of that of O1 as it is. `found`:
/// the alignment of O1 as it is, with the same options. Nothing if O1 fits as it is, to 2 % of its radius of
/// gyration, or if no ratio fits to 10 %. O1 is scaled about the origin of its coordinates, as a conversion
/// of units does. A flat O1 fits in any unit. Errors as of align(). Cost: linear in O1, and that of up to 8
/// alignments of 1024 samples.
[[nodiscard]] SDM_API std::optional<OtherUnit> find_other_unit(const Mesh& o1, const Sites& o2,
                                                               const Alignment& found,
                                                               const AlignOptions& options = {});

/// The same for points.
[[nodiscard]] SDM_API std::optional<OtherUnit> find_other_unit(std::span<const Vec3> points,
                                                               std::span<const Vec3> normals, const Sites& o2,
                                                               const Alignment& found,
                                                               const AlignOptions& options = {});

/// The same without an alignment, for an O1 that is in place: returns the ratio of two units that scales O1,
/// about the origin of its coordinates, to the box of O2, up to 5 % of the diagonal; otherwise the one whose
/// misfit is the least, if that is at most 2 % and a quarter of a misfit as given above 2 %. Nothing unless
/// sizes_differ(). Throws sdm::Error if a mesh is unusable (see validate), or if there is not enough memory.
/// Cost: linear in O1; if the sizes differ, also that of Sites of O2.
[[nodiscard]] SDM_API std::optional<OtherUnit> find_other_unit_in_place(const Mesh& o1, const Mesh& o2);

/// The same for points, all with finite coordinates. Nothing without points.
[[nodiscard]] SDM_API std::optional<OtherUnit> find_other_unit_in_place(std::span<const Vec3> points,
                                                                        const Mesh& o2);

/// Whether the diagonals of two boxes differ as much as units do: by more than 5 times.
[[nodiscard]] SDM_API bool sizes_differ(const Box& a, const Box& b);

/// What a doubt is about.
enum class DoubtReason {
  other_unit,    ///< in another unit of length, O1 fits O2 far better
  mirrored,      ///< the mirror image of O1 fits O2 far better
  poor_fit,      ///< after an alignment, most samples of O1 do not fit O2
  undetermined,  ///< the surfaces do not determine all freedoms of the alignment
  low_coverage,  ///< too little of O2 has a measured point near it
  thin_walls,    ///< the closest point may be on the other skin of a wall, and nothing else decides
};

template <>
inline constexpr std::array kWords<DoubtReason>{"other unit",   "mirrored",     "poor fit",
                                                "undetermined", "low coverage", "thin walls"};

/// A reason not to trust that all distances are within a tolerance, although they are.
struct Doubt {
  DoubtReason reason = DoubtReason::other_unit;
  std::string text{};    ///< a clause: what was found
  std::string remedy{};  ///< a clause: what mends it, by the options of the command
};

template <>
inline constexpr std::tuple kFields<Doubt>{
    Field{"reason", &Doubt::reason, "What it is about."}, Field{"text", &Doubt::text, "What was found."},
    Field{"remedy", &Doubt::remedy, "What mends it, by the options of the command."}};

/// Returns the doubts that an alignment leaves: O1 fits in another unit, or mirrored, less than half of the
/// samples fit (Alignment::fraction_fitting), or a degree of freedom is free.
[[nodiscard]] SDM_API std::vector<Doubt> doubts_of(const Alignment& alignment,
                                                   const std::optional<OtherUnit>& other_unit,
                                                   const std::optional<MirroredFit>& mirrored = {});

/// Returns the doubt that O1 is in another unit, of find_other_unit() or find_other_unit_in_place().
[[nodiscard]] SDM_API Doubt doubt_of(const OtherUnit& unit);

/// Returns the doubt that a coverage below `least` leaves: by its value, not by its bounds.
[[nodiscard]] SDM_API std::optional<Doubt> doubt_of(const Coverage& coverage, double least);

}  // namespace sdm
