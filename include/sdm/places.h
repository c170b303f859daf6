/// Places: where a surface or a cloud deviates most, as regions and not as single points, of which noise and
/// outliers have many.
///
/// Threads: the functions may be called concurrently, also with the same map.
#pragma once

#include <sdm/map.h>
#include <sdm/mesh_attributes.h>
#include <sdm/names.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>
#include <sdm/types.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

/// A region whose distances are all beyond the limit on the same side, or which has no distances. All its
/// faces are judged by the same rows of a table.
struct Place {
  /// The distance of the sample that is farthest beyond its limit; NaN where a tolerance asks for values, and
  /// the samples have none.
  double distance = 0;
  Tolerance limits{};            ///< of that sample; infinite where there is none on a side
  Vec3 point{};                  ///< of that sample
  std::uint64_t sample = kNone;  ///< the texel, kNone for a vertex; of a cloud the place in the file, from 0
  std::uint32_t face = kNone;    ///< of the surface, with the sample; of a cloud its closest face of O2
  std::size_t samples = 0;       ///< texels, without vertices; or points
  double area = 0;               ///< of its texels, in squared units of the mesh; 0 of a cloud
  double fraction = 0;           ///< of the area of all texels, or of all points with coordinates
  bool small = false;            ///< below Places::least_fraction
  std::string kind{}, group{};   ///< of the first name that the face has, as of FaceNames; empty without one
};

template <>
inline constexpr std::tuple kFields<Place>{
    Field{"distance", &Place::distance,
          "Of its samples the one that is farthest beyond the limit; NaN where a tolerance asks for values, "
          "and there are none."},
    Field{"point", &Place::point, "Where that is."},
    Field{"sample", &Place::sample,
          "The texel of that sample, and nothing for a vertex; of a cloud its place in the file, from 0.",
          true},
    Field{"face", &Place::face, "The face that has this sample; of a cloud the closest one of O2.", true},
    Field{"samples", &Place::samples, "The number of its texels, without vertices; or of its points."},
    Field{"area", &Place::area, "An estimate of its area, in squared units; 0 of a cloud."},
    Field{"fraction", &Place::fraction, "Of the area of all texels, or of all points."},
    Field{"kind", &Place::kind, "The kind of the group."},
    Field{"group", &Place::group, "The first name that its face has; empty without one."},
    Field{"small", &Place::small, "Whether it is below the least fraction of all places."},
    Field{"limits", &Place::limits, "The limits of that sample: those of the tolerance, and of its group."}};

/// Together, without a list: no place is left out of the counts.
struct PlaceTotals {
  std::size_t count = 0, samples = 0;
  double area = 0, fraction = 0;
};

template <>
inline constexpr std::tuple kFields<PlaceTotals>{
    Field{"count", &PlaceTotals::count, "The number of places."},
    Field{"samples", &PlaceTotals::samples, "The number of their texels, or points."},
    Field{"area", &PlaceTotals::area, "An estimate of their area, in squared units; 0 of a cloud."},
    Field{"fraction", &PlaceTotals::fraction, "Of the area of all texels, or of all points."}};

/// The places of a map or a cloud.
struct Places {
  /// Distances out of these belong to places, but for faces that have limits of their own. Infinite if only
  /// these are judged.
  Tolerance limits{};
  bool by_tolerance = false;  ///< the limits are those of the tolerances; otherwise ±`p99_abs`
  double least_fraction = 0;  ///< of the area or the points: places below it are small
  PlaceTotals large, small;
  /// The first kListed places: those that are not small, then the small ones, both by how far they are beyond
  /// the limit; those without a value come last, by their extent.
  std::vector<Place> largest;

  static constexpr std::size_t kListed = 10;
};

template <>
inline constexpr std::tuple kFields<Places>{
    Field{
        "limits", &Places::limits,
        "Distances out of these belong to places, but for groups with a tolerance of their own. Infinite if "
        "only these are judged."},
    Field{"by_tolerance", &Places::by_tolerance,
          "The limits are the tolerance; otherwise nothing is out of it, and they are the 99th percentile of "
          "the absolute distance."},
    Field{"least_fraction", &Places::least_fraction, "Places below it are small."},
    Field{"large", &Places::large, "All places that are not small."},
    Field{"small", &Places::small, "All places that are small."},
    Field{"largest", &Places::largest,
          "At most ten: by how far they are beyond the limits, the small ones last."}};

/// Options of find_places().
struct PlacesOptions {
  std::optional<Tolerance> tolerance{};     ///< of all faces
  std::span<const GroupTolerance> table{};  ///< of the faces with these `names`, in addition
  double accuracy = 0;                      ///< of a distance, as for tolerance_shares(); finite
  double p99_abs = 0;                       ///< DistanceStatistics::p99_abs of the map
  std::span<const FaceNames> names{};       ///< of the faces of the surface
};

/// Returns the places of a map: connected regions of texels and vertices out of the tolerances of their faces
/// by more than the accuracy, or without a value; or, without a tolerance or where nothing is out of it, at
/// or beyond the 99th percentile of |d| and the accuracy. Regions beyond opposite limits, or of faces that
/// other rows of the table judge, are separate. Texels are connected if they are among the eight around each
/// other in a chart of the atlas, or at the same point of an edge between charts, up to a texel and a half;
/// vertices with the texels around them. A place is small if its area is less than 1e-5 of that of all
/// texels, or than that of four texels of mean size. Areas are estimates.
///
/// `vertex_distances`: the distance at each vertex of surface.mesh(), NaN if it has no value; empty: none.
/// Throws sdm::Error if the map or the distances belong to another surface. Cost: linear in texels and, where
/// there is a place, faces.
[[nodiscard]] SDM_API Places find_places(const Surface& surface, const DistanceMap& map,
                                         std::span<const float> vertex_distances,
                                         const PlacesOptions& options);

/// Names the group of a place by its face: the first name that the face has. Cost: O(1).
SDM_API void name_group(Place& place, std::span<const FaceNames> names);

/// Flags the small ones of all places, adds up both kinds, and lists the largest. The limits and the least
/// fraction of `result` are known. Cost: O(n log n).
SDM_API void rank_places(std::vector<Place> all, Places& result);

/// The places of maps of parts of a surface, such as UDIM tiles, as of one whose parts have these areas:
/// those by the tolerance, if one of them has such, and none otherwise. Places are not joined over the
/// borders of parts.
[[nodiscard]] SDM_API std::optional<Places> combined_places(std::span<const Places> places,
                                                            std::span<const double> areas);

}  // namespace sdm
