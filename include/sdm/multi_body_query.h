/// Proximity of many bodies: all pairs, and the distance map of each body to all others.
#pragma once

#include <sdm/api.h>
#include <sdm/bounds.h>
#include <sdm/map.h>
#include <sdm/proximity_query.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace sdm {

/// Options of a MultiBodyQuery.
struct MultiBodyOptions {
  /// Greater than 0, in units of the meshes. Pairs farther apart than this are not reported.
  double max_distance = std::numeric_limits<double>::infinity();
  std::optional<double> depth_precision{};  ///< as that of ProximityOptions
  double contact_margin = 0;                ///< as that of ProximityOptions
};

/// The results of ProximityQuery for one pair: O1 is `first`, O2 is `second`.
struct PairProximity {
  std::uint32_t first = kNone, second = kNone;  ///< first < second
  BoundedLength separation{};
  bool colliding = false;
  std::optional<BoundedLength> penetration_depth{};
};

/// A contact of two bodies, as reported by ProximityQuery: O1 is `first`, O2 is `second`.
struct BodyContact {
  std::uint32_t first = kNone, second = kNone;  ///< first < second
  Contact contact{};
};

/// The distance map of one body to all others.
struct NearestMap {
  /// As computed by compute_map with all bodies in their poses, at each texel to the body with the nearest
  /// surface, or to the one with the lowest index if several are equally near. The sign is that of that body
  /// alone: negative inside it if it is closed and orientable.
  DistanceMap map;
  /// The index of that body for each texel; kNone where the map has no value.
  std::vector<std::uint32_t> body;
};

/// Proximity of bodies that move and deform, each against all others, for simulation loops. A body is a shape
/// in a pose, as in ProximityQuery; many bodies can share a shape.
///
/// Threads: an object is used by one thread at a time, but for const functions, which may run concurrently;
/// objects that share shapes may be used concurrently.
class SDM_API MultiBodyQuery {
 public:
  /// Builds the sites of every body; any number of bodies is allowed, including 0. Throws sdm::Error as Sites
  /// does, naming the body, and for a maximum distance that is not positive. Cost: that of all sites.
  explicit MultiBodyQuery(std::vector<Mesh> meshes, const MultiBodyOptions& options = {});
  /// The same for shapes that are there already, or that have an atlas, for maps. Cost: constant for each.
  explicit MultiBodyQuery(std::vector<Shape> shapes, const MultiBodyOptions& options = {});
  ~MultiBodyQuery();
  MultiBodyQuery(MultiBodyQuery&&) noexcept;
  MultiBodyQuery& operator=(MultiBodyQuery&&) noexcept;

  /// The number of bodies.
  [[nodiscard]] std::size_t size() const;

  /// Sets the pose of a body, as ProximityQuery::set_pose does. Throws sdm::Error, and changes nothing, also
  /// for a body that does not exist. Cost: constant.
  void set_pose(std::size_t body, const Transform& pose);
  /// The same for all bodies: one pose per body.
  void set_poses(std::span<const Transform> poses);
  /// The pose of a body. Throws sdm::Error for a body that does not exist.
  [[nodiscard]] Transform pose(std::size_t body) const;

  /// Moves the vertices of a body, keeping its triangles and its pose. Throws sdm::Error, and changes
  /// nothing, for a body that does not exist or whose Shape is shared, a wrong number of positions, or a
  /// coordinate that is not finite or beyond 1e37. If there is not enough memory, it also throws, and changes
  /// nothing or leaves the object broken (see sdm/error.h). Cost: linear.
  void refit(std::size_t body, std::span<const Vec3> positions);
  /// The same for all bodies, on all cores: one entry per body; an empty one leaves the body unchanged.
  void refit(std::span<const std::span<const Vec3>> positions);

  /// Returns all pairs that collide or whose separation is at most max_distance. Sorted by first, then by
  /// second body. The results of a pair are those of ProximityQuery. Computed by the first call after a body
  /// has moved, and valid until one moves again. Throws sdm::Error if there is not enough memory, as
  /// contacts() does; the next call then computes them. Neither this nor refit() allocates memory once the
  /// bodies have been through similar poses, unless a solid intersects itself. Cost: a sweep over the boxes
  /// of the bodies, then that of ProximityQuery for each candidate pair, the pairs distributed over all
  /// cores.
  [[nodiscard]] std::span<const PairProximity> pairs();
  /// Returns the contacts of all pairs, those of each pair as by ProximityQuery::contacts, sorted by first,
  /// then by second body. Computed by the first call after a body has moved, and valid until one moves again.
  /// Cost: a sweep over the boxes of the bodies, then that of ProximityQuery::contacts for each pair whose
  /// boxes are within the margin.
  [[nodiscard]] std::span<const BodyContact> contacts();
  /// The number of pairs whose boxes were within max_distance of each other when pairs() was last computed.
  [[nodiscard]] std::size_t candidate_pairs() const;

  /// Returns the distances from the texels of a body to the nearest other body; texels with none within
  /// max_distance have no value. Throws sdm::Error for a body that does not exist or has no atlas, or if
  /// there is not enough memory. Cost: that of compute_map to each body whose box is nearer than the
  /// distances found so far, all cores.
  [[nodiscard]] NearestMap nearest_map(std::size_t body) const;
  /// The same, into `nearest`, whose memory is reused where possible. If it throws, the values of `nearest`
  /// are unspecified.
  void nearest_map(std::size_t body, NearestMap& nearest) const;

  /// The atlas and the sites of a body, in the frame of its mesh, without the pose. Both throw sdm::Error for
  /// a body that does not exist, surface() also for one without an atlas.
  [[nodiscard]] const Surface& surface(std::size_t body) const;
  /// As surface().
  [[nodiscard]] const Sites& sites(std::size_t body) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the distance from each vertex of a body to the nearest other body, signed as in nearest_map; NaN
/// where none is within max_distance. Throws sdm::Error for a body that does not exist. Cost: that of
/// closest_points to every other body.
[[nodiscard]] SDM_API std::vector<float> nearest_distances_at_vertices(const MultiBodyQuery& bodies,
                                                                       std::size_t body, double max_distance);

}  // namespace sdm
