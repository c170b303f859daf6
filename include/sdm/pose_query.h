/// Proximity of one shape in many poses to bodies at rest, as of a gripper that looks for a grasp.
#pragma once

#include <sdm/api.h>
#include <sdm/bounds.h>
#include <sdm/proximity_query.h>
#include <sdm/shape.h>
#include <sdm/transform.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// Options of a PoseQuery.
struct PoseQueryOptions {
  std::optional<double> depth_precision{};  ///< as that of ProximityOptions
};

template <>
inline constexpr auto kOptions<PoseQueryOptions> = std::tuple{depth_precision_option<PoseQueryOptions>()};

/// Proximity of a shape in many poses to obstacles: other shapes, each in one pose.
///
/// The answers for a pose are those of ProximityQuery with the shape as O1 and each of the obstacles as O2.
/// Each call asks for all poses, on all cores; the results do not depend on how many, nor on the order of the
/// poses. Consecutive poses that are near each other take less time. But for the vector that is returned, no
/// call allocates memory once the shape has been in similar poses, unless a solid intersects itself.
///
/// All calls throw sdm::Error for a pose that ProximityQuery::set_pose refuses, and name one such pose, and
/// if there is not enough memory; values of `results` are then unspecified. Those with `results` also throw
/// for another number of results than of poses.
///
/// Threads: an object is used by one thread at a time; objects that share shapes may be used concurrently.
class SDM_API PoseQuery {
 public:
  /// Any number of obstacles is allowed, including 0. Throws sdm::Error for options that are out of range.
  /// Cost: constant for each obstacle.
  PoseQuery(Shape shape, std::vector<Shape> obstacles, const PoseQueryOptions& options = {});
  /// The same for one obstacle.
  PoseQuery(Shape shape, Shape obstacle, const PoseQueryOptions& options = {});
  ~PoseQuery();
  PoseQuery(PoseQuery&&) noexcept;
  PoseQuery& operator=(PoseQuery&&) noexcept;

  /// Sets the pose of an obstacle, initially the identity, as ProximityQuery::set_pose does. Throws
  /// sdm::Error, and changes nothing, also for an obstacle that does not exist. Cost: constant.
  void set_pose(std::size_t obstacle, const Transform& pose);

  /// Returns whether the shape collides with any obstacle, 1 or 0 for each pose. Exact.
  [[nodiscard]] std::vector<std::uint8_t> colliding(std::span<const Transform> poses);
  /// The same, into `results`.
  void colliding(std::span<const Transform> poses, std::span<std::uint8_t> results);

  /// Returns the smallest distance between the surfaces of the shape and of any obstacle for each pose:
  /// exact, 0 if they intersect; infinite if it is more than `max_distance`, > 0. Throws sdm::Error for any
  /// other maximum distance. A smaller one takes less time.
  [[nodiscard]] std::vector<double> separations(
      std::span<const Transform> poses, double max_distance = std::numeric_limits<double>::infinity());
  /// The same, into `results`.
  void separations(std::span<const Transform> poses, double max_distance, std::span<double> results);

  /// Returns the largest penetration depth of the shape and any obstacle for each pose, of the pairs of which
  /// one is a solid: exactly 0 without a collision, otherwise bounded; all numbers are NaN if there is no
  /// such pair.
  [[nodiscard]] std::vector<BoundedNumber> penetration_depths(std::span<const Transform> poses);
  /// The same, into `results`.
  void penetration_depths(std::span<const Transform> poses, std::span<BoundedNumber> results);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm
