/// Rays against O2: first hits, occlusion, and the ambient occlusion of O1.
///
/// Threads: the functions may be called concurrently, also with the same Surface and Sites.
#pragma once

#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/options.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/types.h>

#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// The points origin + t·direction with t_min ≤ t ≤ t_max; t is a length if the direction has length 1.
struct Ray {
  Vec3 origin{}, direction{};
  double t_min = 0;  ///< at least 0; up to here the ray is known to be free, for example by free_distances()
  double t_max = kInfinity;
};

template <>
inline constexpr std::tuple kOptions<Ray>{
    Option{.name = "t_min",
           .member = &Ray::t_min,
           .text = "Rays begin there, at origin + t · direction.",
           .range = {.least = 0, .most = kInfinity}},
    Option{
        .name = "t_max", .member = &Ray::t_max, .text = "Rays end there.", .range = {-kInfinity, kInfinity}}};

/// The first point of O2 on a ray; without a face if the ray does not meet O2. The weights of the face's
/// corners are not negative; their point is that of t to rounding; of a needle, to 1e-7 of its length.
struct RayHit : SurfacePoint {
  double t = kInfinity;

  friend bool operator==(const RayHit&, const RayHit&) = default;
};

/// Options of first_hits() and occluded().
struct RayOptions {
  Progress progress{};
};

/// Returns the first hit of each ray. O2 is the union of its closed faces, edges and vertices; faces without
/// area are their edges, and the faces that Sites ignores are not hit. Of several faces at the same t the one
/// with the smallest index is returned.
///
/// Whether a ray's line meets a face, and whether t is negative, is exact: no ray passes between two faces
/// that share an edge or a vertex. A ray in the plane of a face hits it where it enters the face, or at t_min
/// inside it. t is rounded, by at most 1e-11 of the distance from the origin to the farthest corner of the
/// face; t_min and t_max are compared with the rounded t. The result does not depend on the other rays, on
/// the instruction set or on the number of threads.
///
/// Throws sdm::Error for an origin with a coordinate that is NaN or beyond 1e37, for a direction whose
/// largest component is not between 1e-30 and 1e37, and for a t_min that is negative or NaN, or a t_max that
/// is NaN; Cancelled. Cost: one traversal of the tree over the faces for each ray with t_min ≤ t_max, all
/// cores. Consecutive rays with similar origins and directions are faster.
[[nodiscard]] SDM_API std::vector<RayHit> first_hits(const Sites& sites, std::span<const Ray> rays,
                                                     const RayOptions& options = {});

/// Returns 1 for each ray that meets O2, otherwise 0: first_hits() with a face. Throws as first_hits does.
/// Cost: at most that of first_hits(); a traversal ends at the first face that it finds.
[[nodiscard]] SDM_API std::vector<std::uint8_t> occluded(const Sites& sites, std::span<const Ray> rays,
                                                         const RayOptions& options = {});

/// Returns, for each texel, a radius within which there is no point of O2: the distance of the map less the
/// largest error that an engine may make (EngineInfo::relative_error), at least 0; 0 where the map has no
/// value. The t_min of rays of unit direction that start at the texel's surface point. The map must be one of
/// this surface to these sites in their present shapes.
/// Throws sdm::Error if its resolution is not that of the surface, or if its distances are not to the closest
/// point. Cost: linear.
[[nodiscard]] SDM_API std::vector<double> free_distances(const Surface& surface, const Sites& sites,
                                                         const DistanceMap& map);

/// Options of ambient_occlusion().
struct AmbientOcclusionOptions {
  std::uint32_t rays = 64;  ///< for each sample, 1 to 65536
  /// Greater than 0, in units of the meshes. O2 occludes nothing that is farther away than this.
  double max_distance = kInfinity;
  std::uint64_t seed = 0;  ///< of the directions
  Progress progress{};
};

inline constexpr OptionRange kOcclusionRays{1, 1 << 16};
inline constexpr const char* kOcclusionRaysText = "Of ambient_occlusion: rays from each point.";
inline constexpr const char* kOcclusionDistanceText =
    "Of ambient_occlusion: what is farther away occludes nothing.";

template <>
inline constexpr auto kOptions<AmbientOcclusionOptions> =
    std::tuple{Option{.name = "rays",
                      .member = &AmbientOcclusionOptions::rays,
                      .text = kOcclusionRaysText,
                      .range = kOcclusionRays,
                      .value = "N"},
               max_distance_option<AmbientOcclusionOptions>(kOcclusionDistanceText),
               Option{.name = "seed",
                      .member = &AmbientOcclusionOptions::seed,
                      .text = "Of ambient_occlusion: what the directions of its rays depend on.",
                      .range = {.least = 0},
                      .value = "N"}};

/// Returns, for each texel, the fraction of rays that do not meet O2, or NaN if no face owns the texel. Rays
/// start at the texel's surface point, on the side to which the normal of its face points, with a density
/// proportional to the cosine of the angle to the normal: the result is an estimate of
///   1/π ∫ visible(ω) (n·ω) dω,
/// 1 where the whole hemisphere is free. O1 does not occlude itself. Directions are stratified, differ from
/// texel to texel and depend on the seed only.
///
/// The map's distances are where the rays start (free_distances(), with the same requirements): a sample
/// farther than max_distance from O2 needs no ray. The result is the same with any such map. Throws
/// sdm::Error for options out of range or a map of another resolution, or if there is not enough memory;
/// Cancelled. Cost: `rays` rays for each other sample, all cores.
[[nodiscard]] SDM_API std::vector<float> ambient_occlusion(const Surface& surface, const Sites& sites,
                                                           const DistanceMap& map,
                                                           const AmbientOcclusionOptions& options = {});

}  // namespace sdm
