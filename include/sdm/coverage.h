/// How much of O2 was measured.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>
#include <sdm/names.h>
#include <sdm/progress.h>
#include <sdm/sites.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
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

}  // namespace sdm
