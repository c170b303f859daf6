/// The surface distance map: at every sample of O1, which are the texels of its atlas and one point of each
/// face without one, the distance to O2; the same at vertices, and the channels that are read from a map.
///
/// Threads: the functions may be called concurrently, also with the same Surface and Sites, if the maps that
/// they write differ.
#pragma once

#include <sdm/engine.h>
#include <sdm/execution.h>
#include <sdm/mesh.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
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

/// Options of compute_map().
struct MapOptions {
  std::shared_ptr<const Engine> engine{};  ///< null: the cpu engine
  SignMethod sign = SignMethod::automatic;
  /// Greater than 0, in units of the meshes. Texels farther than this have no value (NaN).
  double max_distance = kInfinity;
  /// An angle in degrees, above 0 and up to 180: distances are to the closest of the faces of O2 whose normal
  /// is within it of the normal of the sample's face (see sdm/closest_points.h). Nothing: to the closest
  /// point.
  std::optional<double> facing{};
  Progress progress{};
};

/// Facing faces have a side, by which their distances are signed.
inline constexpr std::array kFacingExcludes{
    ExcludedOption{"sign", "distances have the sign of the side of the faces", "exact winding"}};

template <>
inline constexpr auto kOptions<MapOptions> = std::tuple{
    max_distance_option<MapOptions>(), Option{.name = "sign", .member = &MapOptions::sign, .text = kSignText},
    facing_option<MapOptions>(kFacingExcludes)};

/// One value per texel, resolution · rows(), row 0 at the top, and after them one for each face that owns no
/// texel, as Surface::map_faces(). Texels without a value, because no face owns them, O2 is farther than
/// max_distance or no face of O2 faces as they do, hold NaN, kNone and SiteType::none.
struct DistanceMap {
  std::uint32_t resolution = 0;     ///< texels per row
  std::size_t without_texel = 0;    ///< the number of values of faces that own no texel
  std::vector<float> distance;      ///< |vector|, negative inside O2 if signed
  std::vector<Vec3f> vector;        ///< closest point of O2 − texel's surface point
  std::vector<std::uint32_t> site;  ///< index of the closest site among those of its type
  std::vector<SiteType> site_type;
  SignUsed sign;
  MeasuredDistance measured;
  std::size_t beyond_max_distance = 0;  ///< samples without a value, besides the next ones
  std::size_t without_match = 0;        ///< samples that no face of O2 is allowed for
  std::vector<std::uint8_t> unmatched;  ///< flags of these samples; empty if there are none

  /// The number of values of texels, which come first.
  [[nodiscard]] std::size_t texels() const { return distance.size() - without_texel; }
  /// Texels per column, as Surface::rows().
  [[nodiscard]] std::uint32_t rows() const {
    return resolution == 0 ? 0 : static_cast<std::uint32_t>(texels() / resolution);
  }
};

/// Computes the map. Distance and vector are those to a closest site, evaluated in double and stored in
/// float; the site is closest to within 1e-6 (cpu) or 2e-6 (gl) of the diagonal of both meshes, or double
/// rounding (reference). Throws sdm::Error for a sign method that O2 does not allow, for a max_distance that
/// is not positive, for an angle of `facing` out of range, if the engine fails, or if there is not enough
/// memory; Cancelled. Cost: depends on the engine; for cpu, one search per owned texel, all cores.
[[nodiscard]] SDM_API DistanceMap compute_map(const Surface& surface, const Sites& sites,
                                              const MapOptions& options = {});

/// The same, into `map`, whose memory is reused where possible: for sequences of frames. If it throws, the
/// values of the map are unspecified.
SDM_API void compute_map(const Surface& surface, const Sites& sites, const MapOptions& options,
                         DistanceMap& map);

/// Returns the sign that distances with these options have: choose_sign(sites, options.sign) or, if they are
/// to faces that face the samples, the side of the face. Throws sdm::Error as choose_sign() does, and for a
/// sign method that options.facing excludes.
[[nodiscard]] SDM_API SignUsed choose_sign(const Sites& sites, const MapOptions& options);

/// Whether the signs of distances are estimates. Of facing faces and along lines, the sign is the side of the
/// face that is hit, by definition.
[[nodiscard]] constexpr bool has_estimated_signs(DistanceKind kind, SignMethod sign) {
  return kind == DistanceKind::closest && is_estimate(sign);
}

/// Whether distances at the boundary of an open O2 have no sign: SignMethod::side of the closest point.
[[nodiscard]] constexpr bool lacks_boundary_signs(DistanceKind kind, SignMethod sign) {
  return kind == DistanceKind::closest && sign == SignMethod::side;
}

/// Returns what distances with these options are to. Throws sdm::Error if options.facing is out of range.
[[nodiscard]] SDM_API MeasuredDistance measured_distance(const MapOptions& options);

/// Returns, for each value, 1 if its closest site is a boundary edge of an open O2 or a vertex of one,
/// otherwise 0. Such samples may lie beside the part that O2 covers, where distances do not compare the two
/// surfaces. The map must be one to these sites. Throws sdm::Error if it names a site that does not exist.
/// Cost: linear.
[[nodiscard]] SDM_API std::vector<std::uint8_t> boundary_mask(const Sites& sites, const DistanceMap& map);

// Parts of a map: for programs that divide it among processes, or into steps between which they do something
// else.

/// A range of the samples of a surface, by their places in Surface::sample_texels().
struct SampleRange {
  std::size_t first = 0, count = 0;
};

/// Returns the number of samples that are searched together: ranges for compute_samples() begin and end at
/// its multiples, or at the end of the samples. A power of four, at most 65,536 and mostly between a 32nd and
/// a 128th of the samples. Cost: O(1).
[[nodiscard]] SDM_API std::size_t sample_range_grain(const Surface& surface);

/// Returns a map of the surface, without a value at any sample. Throws sdm::Error if there
/// is not enough memory. Cost: linear.
[[nodiscard]] SDM_API DistanceMap empty_map(const Surface& surface);

/// Computes the values of some samples and stores them; the others keep theirs. Once
/// this was called for ranges that cover all samples, in any order, with the same arguments otherwise, the
/// arrays and the sign of the map are those of compute_map() to the bit; beyond_max_distance and
/// without_match count the samples of this range (see count_missing()). Throws sdm::Error as compute_map()
/// does, if `map` has another size than the atlas, for ranges other than those of sample_range_grain(), and
/// for engines that compute whole maps only. Cost: as compute_map(), by the samples of the range, and with
/// options.facing linear in the faces of the surface.
SDM_API void compute_samples(const Surface& surface, const Sites& sites, const MapOptions& options,
                             const SampleRange& range, DistanceMap& map);

/// Counts beyond_max_distance and without_match of a map that was computed in ranges, in any order, as
/// compute_map() has them. Throws sdm::Error if it belongs to another surface. Cost: linear.
SDM_API void count_missing(const Surface& surface, DistanceMap& map);

/// Returns the distance from each vertex of `mesh` to O2, NaN beyond options.max_distance; signed as by
/// compute_map with the same options. With options.facing, each face around a vertex has a distance there, by
/// its own normal; the result is the one of least absolute value, NaN if no face has one. An engine that
/// takes no points (EngineInfo::takes_points) is replaced by cpu. Throws sdm::Error as closest_points does,
/// and for a sign method that O2 does not allow; Cancelled. Cost: that of closest_points; with
/// options.facing, another search for each face around a vertex whose closest point it does not allow. For
/// other measures, see sdm/measure.h.
[[nodiscard]] SDM_API std::vector<float> distances_at_vertices(const Mesh& mesh, const Sites& sites,
                                                               const MapOptions& options = {});

/// boundary_mask() of the vertices of `mesh`: for each, 1 if its closest site is a boundary edge of an open
/// O2 or a vertex of one, otherwise 0, also beyond options.max_distance. Distances by SignMethod::side have
/// no sign there. Errors and cost as of closest_points().
[[nodiscard]] SDM_API std::vector<std::uint8_t> boundary_vertices(const Mesh& mesh, const Sites& sites,
                                                                  MapOptions options = {});

// The table of channels: what a map has at each texel, a row for each array. map.exr and the choice of its
// layers, the arrays of the Python package, the values that report.html shows and the columns of the files of
// vertices are made from it. docs/design/house.md describes how to add a row.

namespace map {
class TexelBlock;
}

/// The type of a channel's numbers. In map.exr 64-bit floats have 32 bits, and whole numbers too.
enum class ChannelType : std::uint8_t { float32, float64, uint32, uint8 };

/// A row of the table.
struct Channel {
  const char* name;   ///< of the array in Python and of the column in files of vertices
  const char* layer;  ///< of map.exr, to be chosen there; empty: in all that have what the row needs
  std::array<const char*, 3> planes{};  ///< the names of its components in map.exr; null: no more of them
  const char* description;              ///< a phrase without a full stop
  bool is_length = false;               ///< in the units of the meshes; otherwise without a unit
  bool on_request = false;              ///< in map.exr only if its layer is asked for
  bool in_python = true;                ///< an array of the Python package
  bool on_page = false;                 ///< in report.html, for the texel under the cursor
  bool at_vertices = false;             ///< in the files of vertices; reads nothing but distances
  bool needs_shape = false;             ///< positions of the surface
  bool needs_sites = false;
  bool needs_boundary = false;

  // What follows from how the row is read:
  ChannelType type = ChannelType::float32;
  const char* none = "";  ///< the value of a texel without one, in words
  void (*read)(const map::TexelBlock& block, std::byte* values) = nullptr;
  /// The memory of a channel that maps store; null for one that is computed.
  std::span<const std::byte> (*stored)(const DistanceMap& map) = nullptr;

  /// The number of components of a value, 1 to 3.
  [[nodiscard]] std::size_t components() const {
    std::size_t count = 0;
    while (count < planes.size() && planes[count] != nullptr) ++count;
    return count;
  }
};

/// The table, in the order in which it is listed for users.
[[nodiscard]] SDM_API std::span<const Channel> channels();

/// The bytes of one number of this type.
[[nodiscard]] SDM_API std::size_t size_of(ChannelType type);
/// The name of the type in NumPy, such as "float32".
[[nodiscard]] SDM_API const char* name_of(ChannelType type);

/// The layers of map.exr, in the order of the table.
[[nodiscard]] SDM_API std::vector<std::string> channel_layers();
/// Those that map.exr has unless others are chosen.
[[nodiscard]] SDM_API std::vector<std::string> default_channel_layers();

/// What channels are read from.
struct ChannelSource {
  const DistanceMap* map = nullptr;
  const Surface* surface = nullptr;          ///< on which the map was computed; not for stored channels
  const Sites* sites = nullptr;              ///< of the map, for rows that need them
  std::span<const std::uint8_t> boundary{};  ///< of boundary_mask(), for rows that need it
};

/// Returns the values of each of `channels` at texels, those of one texel together. `texels`: owned ones, or
/// kNone for one without a value; number i stands for texel first + i, which may repeat another one's values.
/// Throws sdm::Error if the source lacks what a channel needs. Cost: constant per value.
[[nodiscard]] SDM_API std::vector<std::vector<std::byte>> read_channels(std::span<const Channel> channels,
                                                                        const ChannelSource& source,
                                                                        std::span<const std::uint32_t> texels,
                                                                        std::uint32_t first = 0);

}  // namespace sdm
