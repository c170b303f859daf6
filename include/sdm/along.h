/// The distance to O2 along a line: the normal of O1, or a direction such as the vertical.
///
/// Threads: the functions may be called concurrently, also with the same Surface and Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/facing.h>
#include <sdm/map.h>
#include <sdm/options.h>
#include <sdm/progress.h>
#include <sdm/sites.h>
#include <sdm/types.h>

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

/// A measure (sdm/measure.h): the distance to the nearest point of O2 on the line through the sample, to both
/// sides, among the faces that face the same way as the sample. With m, the normal of the sample's face, and
/// u, the unit vector along the line, these are the faces whose normal n has
///   n·m > 0                   along normals (u = m)
///   (n·u) (m·u) > 0           along a direction: seen along it, both show the same side
/// by more than 1e-12. Along the vertical, the distance of terrain is its change of height; both surfaces
/// must be oriented alike. `distance` is positive where the sample is on the side of the hit face to which n
/// points: outside or, of terrain with upward normals, above; its SignMethod is `side`.
/// `vector` leads to the hit, on the face `site`.
///
/// Normals of O2 are outward if it is closed and orientable; otherwise those of its file, made consistent
/// within each component. Those of O1 are outward if it is closed and orientable, otherwise as its triangles
/// are oriented in its file.
///
/// Distances are exact to 1e-11 of the size of the meshes and the rounding to float, at the texels. They are
/// not 1-Lipschitz: nothing bounds them in between. Owned texels without a hit have no value, and count as
/// without_match, or as beyond_max_distance if there is a hit that is farther. Throws sdm::Error for a
/// direction that is 0 or not finite, for a max_distance that is not positive, or if there is not enough
/// memory; Cancelled. Cost: two rays for each texel, all cores.
struct AlongOptions {
  /// The direction of all lines, of any length. Nothing: the normal of each sample's face, or of each point.
  std::optional<Vec3> direction{};
  /// Greater than 0, in units of the meshes. Texels farther than this have no value (NaN).
  double max_distance = std::numeric_limits<double>::infinity();
  Progress progress{};
};

inline constexpr std::array kAlongExcludes{ExcludedOption{"sign", "", "none exact winding side"},
                                           ExcludedOption{"engine", "", "gl reference"},
                                           ExcludedOption{"facing"}};

template <>
inline constexpr auto kOptions<AlongOptions> = std::tuple{
    Option{.name = "along",
           .member = &AlongOptions::direction,
           .text =
               "Measure along a line, the normal of each sample's face or a direction, to both sides: to "
               "the nearest face of O2 that faces the same way. Along 0,0,1: the change of height of "
               "terrain. Positive on the side to which the normal of that face points. Between samples, an "
               "estimate.",
           .value = "normal|X,Y,Z",
           .excludes = kAlongExcludes},
    max_distance_option<AlongOptions>()};

/// Measures along lines from points with normals, of any length: `closest` are the hits, of SiteType::face,
/// with the distance without its sign, which is − where `behind`. `unmatched` are the points without a hit at
/// any distance. Without normals, along a direction, all faces count. A point with a normal of 0, or one at a
/// right angle to the direction, has no hit. Also throws for points that are not finite, and unless there is
/// a normal for each point, or none along a direction. Cost: two rays for each point, all cores.
[[nodiscard]] SDM_API FacingPoints closest_points_along(const Sites& sites, std::span<const Vec3> points,
                                                        std::span<const Vec3> normals,
                                                        const AlongOptions& options);

/// What the distances are, in words; `sample` is what they are measured from, such as "sample's face".
[[nodiscard]] SDM_API MeasuredDistance measured_distance(const AlongOptions& options,
                                                         const std::string& sample = "sample's face");

}  // namespace sdm
