/// Statistics of maps: of one, of its parts, of several as of one, and over time.
///
/// Threads: the functions may be called concurrently, also with the same map; an object is used by one thread
/// at a time, but for its const functions.
#pragma once

#include <sdm/map.h>
#include <sdm/names.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// Statistics of the samples that hold a finite value, each weighted by its area on the surface; the areas of
/// all samples add up to that of the mesh. The distances are NaN if there are none.
struct DistanceStatistics {
  std::size_t texels = 0;
  std::size_t negative_texels = 0;
  double min = 0, max = 0, mean = 0, rms = 0, stddev = 0;
  double p01 = 0, p05 = 0, p50 = 0, p95 = 0, p99 = 0;
  double mean_abs = 0, max_abs = 0;
  double p50_abs = 0, p95_abs = 0, p99_abs = 0, p999_abs = 0;
  double negative_area_fraction = 0;
};

template <>
inline constexpr std::tuple kFields<DistanceStatistics>{
    Field{"texels", &DistanceStatistics::texels,
          "The number of samples that have a value: texels, and points of faces without one."},
    Field{"negative_texels", &DistanceStatistics::negative_texels, "The number of those that are negative."},
    Field{"min", &DistanceStatistics::min, "The smallest distance."},
    Field{"max", &DistanceStatistics::max, "The largest distance."},
    Field{"mean", &DistanceStatistics::mean, "The mean."},
    Field{"rms", &DistanceStatistics::rms, "The root of the mean of the squares."},
    Field{"stddev", &DistanceStatistics::stddev, "The standard deviation, about the mean."},
    Field{"p01", &DistanceStatistics::p01, "The distance that 1 % of the area is at or below."},
    Field{"p05", &DistanceStatistics::p05, "The distance that 5 % of the area is at or below."},
    Field{"p50", &DistanceStatistics::p50, "The median: half of the area is at or below."},
    Field{"p95", &DistanceStatistics::p95, "The distance that 95 % of the area is at or below."},
    Field{"p99", &DistanceStatistics::p99, "The distance that 99 % of the area is at or below."},
    Field{"mean_abs", &DistanceStatistics::mean_abs, "The mean of the absolute distances."},
    Field{"max_abs", &DistanceStatistics::max_abs, "The largest absolute distance."},
    Field{"p50_abs", &DistanceStatistics::p50_abs, "The median of the absolute distances."},
    Field{"p95_abs", &DistanceStatistics::p95_abs,
          "The absolute distance that 95 % of the area is at or below."},
    Field{"p99_abs", &DistanceStatistics::p99_abs,
          "The absolute distance that 99 % of the area is at or below."},
    Field{"p999_abs", &DistanceStatistics::p999_abs,
          "The absolute distance that 99.9 % of the area is at or below: the largest one but for outliers."},
    Field{"negative_area_fraction", &DistanceStatistics::negative_area_fraction,
          "The fraction of the area with a value, in [0, 1], where it is negative."}};

/// Computes statistics of `map.distance` as it is, signed or not. Throws sdm::Error if the map does not
/// belong to this surface. Cost: linear in texels, all cores.
[[nodiscard]] SDM_API DistanceStatistics statistics(const Surface& surface, const DistanceMap& map);

/// Where a distance was measured.
struct Extreme {
  double distance = 0;
  Vec3 point{};            ///< on the surface
  bool at_vertex = false;  ///< at a vertex of the mesh; otherwise at a sample
};

/// The smallest and the largest distance of all texels and of all vertices of faces that have a value.
struct Extremes {
  Extreme min, max;
};

/// Returns nothing if no texel and no vertex has a value. `vertex_distances`: the distance at each vertex of
/// surface.mesh(), NaN if it has no value. Throws sdm::Error if the map or the distances belong to another
/// surface. Cost: linear in texels and faces.
[[nodiscard]] SDM_API std::optional<Extremes> extremes(const Surface& surface, const DistanceMap& map,
                                                       std::span<const float> vertex_distances);

/// Returns the fraction of the area, in [0, 1], whose |distance| is above `limit`; texels beyond the map's
/// maximum distance count as above. 0 for a map without texels. Cost: O(n) in texels, all cores.
[[nodiscard]] SDM_API double area_fraction_beyond(const Surface& surface, const DistanceMap& map,
                                                  double limit);

/// Returns the fraction of the area of the surface, in [0, 1], that lies in faces without a texel: pictures
/// of its maps do not show it, and each of these faces has one sample. Cost: linear in faces.
[[nodiscard]] SDM_API double area_fraction_without_texels(const Surface& surface);

/// The distances between two numbers, and the fraction of the area that has them.
struct DistanceBand {
  double lower = 0, upper = 0;  ///< −∞ for the first band of a table, ∞ for the last
  double area_fraction = 0;
};

template <>
inline constexpr std::tuple kFields<DistanceBand>{
    Field{"lower", &DistanceBand::lower, "The least distance; infinite for the first band."},
    Field{"upper", &DistanceBand::upper, "The largest one; infinite for the last band."},
    Field{"area_fraction", &DistanceBand::area_fraction, "The fraction of the area that has them."}};

/// Options of distance_bands().
struct DistanceBandOptions {
  double accuracy = 0;  ///< of a distance
  double centre = 0;    ///< of the tolerance, within which rounding counts
};

/// Returns the bands below, between and above `edges`, with fractions of the area of all texels of the map,
/// those without a value included. A distance at an edge, or beyond it by no more than the accuracy, belongs
/// to the band on the side of the centre, so that the bands within a tolerance hold what tolerance_shares()
/// counts as within. Throws sdm::Error unless the edges are finite and increasing and the map belongs to the
/// surface. Cost: linear in texels, times the logarithm of the number of edges, all cores.
[[nodiscard]] SDM_API std::vector<DistanceBand> distance_bands(const Surface& surface, const DistanceMap& map,
                                                               std::span<const double> edges,
                                                               const DistanceBandOptions& options = {});

/// Fractions of the area of all texels of a map, those without a value included.
struct DistanceHistogram {
  double lower = 0, upper = 0;         ///< of all bins together
  std::vector<double> area_fractions;  ///< of bins of equal width; a distance at an edge belongs to the upper
                                       ///< bin, `upper` to the last
  double below = 0, above = 0, without_value = 0;
};

template <>
inline constexpr std::tuple kFields<DistanceHistogram>{
    Field{"lower", &DistanceHistogram::lower, "Where the first bin begins."},
    Field{"upper", &DistanceHistogram::upper, "Where the last bin ends."},
    Field{"area_fractions", &DistanceHistogram::area_fractions,
          "The fraction of the area in each bin, of equal width."},
    Field{"below", &DistanceHistogram::below, "The fraction below the first bin."},
    Field{"above", &DistanceHistogram::above, "The fraction above the last one."},
    Field{"without_value", &DistanceHistogram::without_value, "The fraction without a distance."}};

/// Throws sdm::Error unless the range is finite and increasing and there is a bin, and if the map belongs to
/// another surface. Cost: linear in texels, all cores.
[[nodiscard]] SDM_API DistanceHistogram distance_histogram(const Surface& surface, const DistanceMap& map,
                                                           const std::array<double, 2>& range,
                                                           std::size_t bins);

/// The distances of one part of a surface.
struct PartStatistics {
  std::size_t faces = 0;
  Box box;                                   ///< of the vertices of its faces
  double area_fraction = 0;                  ///< of the area of all texels of the map, in [0, 1]
  DistanceStatistics distance;               ///< of the texels of its faces
  std::optional<ToleranceShares> tolerance;  ///< fractions of the part's own area; if there is one
};

/// Options of part_statistics().
struct PartStatisticsOptions {
  std::optional<Tolerance> tolerance{};
  double accuracy = 0;  ///< of a distance, as for tolerance_shares()
};

/// `part_of_face`: for each face of the surface, the number of its part, below `parts`, or kNone for faces
/// that belong to none. Throws sdm::Error if the map or the parts belong to another surface. Cost: linear in
/// texels and faces, all cores; eight bytes for each texel.
[[nodiscard]] SDM_API std::vector<PartStatistics> part_statistics(const Surface& surface,
                                                                  const DistanceMap& map,
                                                                  std::span<const std::uint32_t> part_of_face,
                                                                  std::size_t parts,
                                                                  const PartStatisticsOptions& options = {});

/// Collects the distances of maps, such as those of the UDIM tiles of a mesh, with their areas: the maps need
/// not be kept.
class SDM_API CombinedStatistics {
 public:
  /// Throws sdm::Error, and changes nothing, if the map does not belong to this surface, or if there is not
  /// enough memory. Cost:
  /// linear in texels; 8 bytes for each texel with a value.
  void add(const Surface& surface, const DistanceMap& map);

  /// As statistics(), over the texels of all maps, each weighted by its area on its surface. Throws
  /// sdm::Error if there is not enough memory. Cost: linear in texels, all cores.
  [[nodiscard]] DistanceStatistics statistics() const;

 private:
  struct Texel {
    float distance, area;
  };
  std::vector<Texel> texels_;
  double unit_ = 0;  ///< of the areas: that of the largest texel of the first map
};

/// The minimum, maximum and mean distance of every texel of an atlas over the added maps; faces without a
/// texel have none. NaN where no face owns the texel, where another face or none owned it in an earlier map,
/// or where it was beyond the maximum distance in one of the maps. Self maps mark the latter by +∞ instead:
/// the minimum is then that over the other maps.
class SDM_API TemporalMaps {
 public:
  /// What a later process needs in order to continue.
  struct State {
    std::size_t maps = 0;
    std::uint32_t resolution = 0;
    std::vector<float> least{}, largest{};  ///< of whole rows of texels, none before the first map
    std::vector<double> sum{};              ///< of the distances, likewise
  };

  TemporalMaps() = default;
  /// Continues from an earlier state: the results are bit for bit those without the interruption. Throws
  /// sdm::Error if the sizes do not match.
  explicit TemporalMaps(State state);

  /// Adds a map. Throws sdm::Error, and changes nothing, if its size differs from that of earlier maps or
  /// there is not enough memory. Cost: O(n) in texels, all cores.
  void add(const DistanceMap& map);

  /// Follows an edit of the surface: texels whose face stays keep their statistics, all others become NaN for
  /// good. `before`: Surface::texel_faces() before Surface::edit. Throws sdm::Error, and changes
  /// nothing, if the sizes do not match or there is not enough memory. Cost: O(n) in texels.
  void follow_edit(std::span<const std::uint32_t> before, const Surface& edited);

  /// The number of maps added.
  [[nodiscard]] std::size_t maps() const { return state_.maps; }
  /// Texels per row; 0 before the first map.
  [[nodiscard]] std::uint32_t resolution() const { return state_.resolution; }
  /// The minimum of each texel, in rows.
  [[nodiscard]] std::span<const float> least() const { return state_.least; }
  /// The maximum of each texel.
  [[nodiscard]] std::span<const float> largest() const { return state_.largest; }
  /// Cost: O(n) in texels.
  [[nodiscard]] std::vector<float> mean() const;
  /// What a later process needs in order to continue.
  [[nodiscard]] const State& state() const { return state_; }

 private:
  State state_;
};

}  // namespace sdm
