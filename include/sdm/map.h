/// The surface distance map: at every sample of O1, which are the texels of its atlas and one point of each
/// face without one, the distance to O2.
///
/// Threads: the functions may be called concurrently, also with the same Surface and Sites, if the maps that
/// they write differ.
#pragma once

#include <sdm/api.h>
#include <sdm/distance_kind.h>
#include <sdm/engine.h>
#include <sdm/options.h>
#include <sdm/progress.h>
#include <sdm/sign.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

/// Options of compute_map().
struct MapOptions {
  std::shared_ptr<const Engine> engine{};  ///< null: the cpu engine
  SignMethod sign = SignMethod::automatic;
  /// Greater than 0, in units of the meshes. Texels farther than this have no value (NaN).
  double max_distance = std::numeric_limits<double>::infinity();
  /// An angle in degrees, above 0 and up to 180: distances are to the closest of the faces of O2 whose normal
  /// is within it of the normal of the sample's face (see sdm/facing.h). Nothing: to the closest point.
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

}  // namespace sdm
