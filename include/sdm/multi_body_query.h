/// Proximity of many bodies: all pairs, and the map of each body to all others.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/proximity_query.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace sdm {

struct MultiBodyOptions {
  AtlasOptions atlas{.resolution = 128};  ///< of each body: its samples are where distances are measured
  /// Separation and collision from the triangles themselves; else from the samples, with their bounds.
  bool exact = false;
  /// Greater than 0, in units of the meshes. Pairs farther apart than this are not reported.
  double max_distance = std::numeric_limits<double>::infinity();
};

/// The results of ProximityQuery for one pair: O1 is `first`, O2 is `second`.
struct PairProximity {
  std::uint32_t first = kNone, second = kNone;  ///< first < second
  BoundedLength separation{};
  BoundedBool colliding{};
  std::optional<BoundedLength> penetration_depth{};
};

/// The map of a body to all others together.
struct NearestMap {
  /// As compute_map writes it, to the body whose surface is nearest at each texel; among equally near ones,
  /// the body with the lowest index. Signed by that body alone: negative inside of it, if it is closed and
  /// orientable.
  DistanceMap map;
  /// That body for each texel; kNone where the map has no value.
  std::vector<std::uint32_t> body;
};

/// Bodies that deform, each against all others: for simulation loops.
class SDM_API MultiBodyQuery {
 public:
  /// Throws sdm::Error as Surface and Sites do, and then names the body, and for a maximum distance that is
  /// not greater than 0. Any number of bodies is allowed, including 0. Cost: all atlases and sites.
  explicit MultiBodyQuery(std::vector<Mesh> meshes, const MultiBodyOptions& options = {});
  ~MultiBodyQuery();
  MultiBodyQuery(MultiBodyQuery&&) noexcept;
  MultiBodyQuery& operator=(MultiBodyQuery&&) noexcept;

  [[nodiscard]] std::size_t size() const;

  /// Moves the vertices of a body, keeping its triangles. Throws sdm::Error, and changes nothing, for a body
  /// that does not exist, a wrong count or a coordinate that is not finite or beyond 1e37. Cost: linear.
  void refit(std::size_t body, std::span<const Vec3> positions);
  /// The same for all bodies, on all cores: one entry per body; an empty one leaves the body unchanged.
  void refit(std::span<const std::span<const Vec3>> positions);

  /// All pairs that collide or whose separation is at most max_distance, and pairs for which the samples
  /// cannot rule this out: none with separation.lower > max_distance unless they collide. Sorted by first,
  /// then by second body. Each has the answers that Query has for its bodies. Computed at the first call
  /// after an update, and valid until the next one. Neither this nor update takes memory once the bodies have
  /// been through such poses. Cost: a sweep over the bodies' boxes; then each candidate pair as by Query, all
  /// cores sharing the pairs.
  [[nodiscard]] std::span<const PairProximity> pairs();
  /// Pairs whose boxes were within max_distance of each other when pairs() was computed last.
  [[nodiscard]] std::size_t candidate_pairs() const;

  /// Distances from each texel of a body to the nearest of the other bodies; where none is within
  /// max_distance, no value. Throws sdm::Error for a body that does not exist and if there is not enough
  /// memory. Cost: of compute_map to those bodies whose boxes are nearer than what has been found, all cores.
  [[nodiscard]] NearestMap nearest_map(std::size_t body) const;
  /// Writes into `nearest`, reusing its memory where possible.
  void nearest_map(std::size_t body, NearestMap& nearest) const;

  /// Throw sdm::Error for a body that does not exist.
  [[nodiscard]] const Surface& surface(std::size_t body) const;
  [[nodiscard]] const Sites& sites(std::size_t body) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The distance of each vertex of a body to the nearest of the other bodies, signed as in nearest_map; NaN
/// where none is within max_distance. Throws sdm::Error for a body that does not exist. Cost: closest_points
/// to each other body.
[[nodiscard]] SDM_API std::vector<float> nearest_distances_at_vertices(const MultiBodyQuery& bodies,
                                                                       std::size_t body, double max_distance);

}  // namespace sdm
