/// What O2 has at the points that belong to O1's texels. A match is the point of O2 whose attributes belong
/// to a texel, also where O2 has thin walls; a transfer takes over values of O2, such as colours or
/// temperatures, from the closest points.
///
/// Threads: the functions may be called concurrently, also with the same Surface and Sites and the same map.
#pragma once

#include <sdm/engine.h>
#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/mesh_attributes.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// How the point of O2 that belongs to a texel was found, or why there is none.
enum class MatchKind : std::uint8_t {
  none,        ///< no face of O1 owns the texel
  closest,     ///< the closest point
  facing,      ///< the closest point of the faces that face as the sample does
  ray,         ///< the nearest hit along the interpolated normal, outwards or inwards, that faces as it does
  too_far,     ///< unmatched: nothing within the largest distance
  facing_away  ///< unmatched: no face faces as the sample does, at any distance
};

/// The numbers of texels that faces own, by their MatchKind.
struct MatchCounts {
  std::size_t closest = 0, facing = 0, ray = 0;  ///< with a point
  std::size_t too_far = 0, facing_away = 0;      ///< without one

  /// The number of texels with a point.
  [[nodiscard]] std::size_t matched() const { return closest + facing + ray; }
};

template <>
inline constexpr std::tuple kFields<MatchCounts>{
    Field{"closest", &MatchCounts::closest, "Texels whose point is the closest one."},
    Field{"facing", &MatchCounts::facing, "Texels whose point is the closest one that faces as they do."},
    Field{"ray", &MatchCounts::ray, "Texels whose point a ray along the normal hits."},
    Field{"too_far", &MatchCounts::too_far,
          "Texels without a point: nothing is within the largest distance."},
    Field{"facing_away", &MatchCounts::facing_away, "Texels without a point: no face faces as they do."}};

/// A point of O2 for each texel of the atlas of O1 (resolution · rows(), row 0 at the top).
struct TexelMatches {
  std::uint32_t resolution = 0;  ///< texels per row
  std::vector<MatchKind> kind;
  std::vector<std::uint32_t> face;                ///< of O2; kNone without a point
  std::vector<std::array<float, 2>> barycentric;  ///< shares of the face's corners 1 and 2

  /// Texels per column, as Surface::rows().
  [[nodiscard]] std::uint32_t rows() const {
    return resolution == 0 ? 0 : static_cast<std::uint32_t>(kind.size() / resolution);
  }
  /// The number of texels of a kind. Cost: linear.
  [[nodiscard]] std::size_t count(MatchKind of) const {
    return static_cast<std::size_t>(std::count(kind.begin(), kind.end(), of));
  }
  /// The numbers of texels of each kind. Cost: linear.
  [[nodiscard]] MatchCounts counts() const {
    return {.closest = count(MatchKind::closest),
            .facing = count(MatchKind::facing),
            .ray = count(MatchKind::ray),
            .too_far = count(MatchKind::too_far),
            .facing_away = count(MatchKind::facing_away)};
  }
  /// The point of a texel; no face without one. Its weights are not negative.
  [[nodiscard]] SurfacePoint point(std::size_t texel) const {
    if (face[texel] == kNone) return {};
    const double b = barycentric[texel][0], c = barycentric[texel][1];
    return {face[texel], {{std::max(0.0, 1 - b - c), b, c}}};
  }
};

/// Which point of O2 belongs to a texel.
enum class MatchMethod : std::uint8_t {
  closest,  ///< the closest one; of a thin wall, that may be one of its other skin
  facing,   ///< the closest one of the faces that face as the sample does
  ray       ///< the nearest hit along the normal of O1, of those faces; where there is none, as `facing`
};

template <>
inline constexpr std::array kWords<MatchMethod>{"closest", "facing", "ray"};

/// Options of match_texels().
struct MatchOptions {
  MatchMethod method = MatchMethod::facing;
  /// An angle in degrees, above 0 and up to 180, for `facing` and `ray`: allowed are the faces of O2 whose
  /// normal is within it of the normal of the sample's face, as closest_facing_points() has it.
  double facing = 90;
  /// How far along the normal, to either side, `ray` searches for hits: greater than 0, in units of the
  /// meshes. Beyond a part of O1, hits may belong to another part of O2.
  double cage = kInfinity;
  /// Greater than 0, in units of the meshes. Points of O2 farther than this do not match.
  double max_distance = kInfinity;
  /// Normals at the corners of O1's faces, such as those of its file, for `ray`; null: smooth_normals(),
  /// which leave no gap between the rays of faces that meet at an edge.
  const MeshAttribute* normals = nullptr;
  std::shared_ptr<const Engine> engine{};  ///< null: the cpu engine
  Progress progress{};
};

template <>
inline constexpr auto kOptions<MatchOptions> = std::tuple{
    Option{.name = "method",
           .member = &MatchOptions::method,
           .text = "Which point of O2 belongs to a texel: the closest one; the closest one of the faces that "
                   "face as the texel does; or, of ray, the nearest hit of such a face along its normal."},
    Option{.name = "facing",
           .member = &MatchOptions::facing,
           .text =
               "Of facing and ray: allowed are the faces whose normal is within this angle of that of the "
               "texel's face.",
           .range = kAngle,
           .unit = "degrees",
           .value = "ANGLE"},
    Option{.name = "cage",
           .member = &MatchOptions::cage,
           .text = "How far ray searches along the normal, to either side.",
           .range = kPositiveOrInfinite,
           .unit = "length",
           .value = "D"},
    max_distance_option<MatchOptions>("Points of O2 farther than this do not match.")};

/// Finds, for each texel, its point of O2.
///
/// Closest points are those of compute_map(), with its precision; on an edge or a vertex, the face is the one
/// around it that faces most as the sample does, if the method takes facing into account, otherwise any.
/// Of `ray`, let n be the normal of the texel, interpolated between the corners of its face; its length does
/// not matter, and where it is 0, n is the normal of the face. The match is the point p + t n̂ with the least
/// |t| ≤ min(cage, max_distance) that lies on an allowed face; of two with opposite t, the one on the side to
/// which the normal of the sample's face points, which is outwards if O1 is closed and orientable. Which
/// lines meet which faces is exact, as of first_hits(): faces that are not allowed are passed, and no other
/// is lost beside them. Texels without such a point have kind `facing`, `too_far` or `facing_away`.
///
/// Throws sdm::Error for options out of range, for normals that do not fit O1, as compute_map() does, and if
/// there is not enough memory; Cancelled. Cost: that of a map; of `ray`, two rays for each texel, and two
/// searches for each texel without a hit; all cores.
[[nodiscard]] SDM_API TexelMatches match_texels(const Surface& surface, const Sites& sites,
                                                const MatchOptions& options = {});

/// Returns the points at the ends of the vectors of a map from this surface to these sites: kind `closest`,
/// `facing` or, of maps along lines, `ray`. Throws sdm::Error for a map of thickness or of another surface or
/// of other sites, as far as it shows, and if there is not enough memory; Cancelled. Cost: linear, all cores.
[[nodiscard]] SDM_API TexelMatches matches_of(const Surface& surface, const Sites& sites,
                                              const DistanceMap& map, const Progress& progress = {});

/// Throws sdm::Error unless the matches have the texels of the surface, and faces of the sites. Cost: linear.
SDM_API void require_matches(const Surface& surface, const Sites& sites, const TexelMatches& matches);

/// What an array over a mesh has a row for.
enum class AttributeDomain : std::uint8_t {
  vertex,  ///< each vertex; linear within faces
  face,    ///< each face; constant within it
  corner,  ///< each corner of each face, number 3 · face + corner; linear within faces
};

template <>
inline constexpr std::array kWords<AttributeDomain>{"vertex", "face", "corner"};

/// An array over the vertices, faces or corners of a mesh.
struct AttributeArray {
  std::span<const float> values;  ///< row after row
  std::size_t components = 1;     ///< of a row
  AttributeDomain domain = AttributeDomain::vertex;
  /// The rows of each face's corners, if corners share rows as in MeshAttribute::rows; kNone has the value
  /// NaN. Empty: every corner has its own.
  std::span<const Triangle> rows{};
};

template <>
inline constexpr std::tuple kOptions<AttributeArray>{
    Option{.name = "components",
           .member = &AttributeArray::components,
           .text = "Numbers of each vertex, face or corner.",
           .range = {1, std::numeric_limits<std::uint32_t>::max()}},
    Option{
        .name = "domain",
        .member = &AttributeArray::domain,
        .text =
            "What the values are of: vertices or corners, between which they are interpolated, or faces."}};

/// Options of transfer().
struct TransferOptions {
  /// Whether the texels of no face get values too, so that filtering at the border of a chart does not blend
  /// in a background: beside charts, within 4 to 16 texels by AtlasOptions::gutter, those of the nearest
  /// texel that has one; elsewhere smooth ones.
  bool fill = true;
  Progress progress{};
};

template <>
inline constexpr auto kOptions<TransferOptions> = std::tuple{
    Option{.name = "fill",
           .member = &TransferOptions::fill,
           .text = "Texels of no face get values too, from texels near them, so that filtering at the border "
                   "of a chart does not blend in a background."}};

/// Returns the values of the array, a row for each texel of the map, at the texel's closest point on O2: that
/// of point_on_face() or, for maps along lines and of thickness, the end of the vector. Values are
/// interpolated in double and stored in float. Texels that a face owns but that have no distance hold NaN; so
/// do, unless they are filled, those that no face owns.
///
/// Of a point on an edge or a vertex, the face is any of those around it: values of faces and corners jump
/// there. A value that is not finite makes those of the texels in its faces not finite; from these, no texel
/// is filled.
///
/// Throws sdm::Error if the array does not fit O2, the map is not one from the surface to the sites, or there
/// is not enough memory; Cancelled. Cost: linear in texels, all cores.
[[nodiscard]] SDM_API std::vector<float> transfer(const Surface& surface, const Sites& sites,
                                                  const DistanceMap& map, const AttributeArray& array,
                                                  const TransferOptions& options = {});

/// The same at the points of matches from this surface to these sites; texels without one hold NaN. Also
/// throws if a match is on a face that O2 does not have.
[[nodiscard]] SDM_API std::vector<float> transfer(const Surface& surface, const Sites& sites,
                                                  const TexelMatches& matches, const AttributeArray& array,
                                                  const TransferOptions& options = {});

}  // namespace sdm
