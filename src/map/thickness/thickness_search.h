// The thickness of a solid at a point of its surface.
#pragma once

#include <sdm/rays.h>

#include <cstdint>
#include <span>
#include <vector>

#include "map/thickness/touching_ball.h"
#include "rays/trace.h"
#include "sites/sites_data.h"
#include "tree/aabb_tree.h"

namespace sdm::thickness {

/// What searches of a solid share.
class Walls {
 public:
  /// `angle` in degrees. Throws sdm::Error unless the mesh is closed and orientable. Cost: linear, all cores.
  Walls(const sites::SitesData& sites, double angle);

  /// Whether the thickness of a face is defined: it is not ignored, and has an area.
  [[nodiscard]] bool measures(std::uint32_t face) const;
  /// The inward unit normal of a face.
  [[nodiscard]] Vec3 inward(std::uint32_t face) const { return -1.0 * outward_[face]; }

 private:
  friend class WallSearch;

  /// Whether face `other` can stop anything that starts at `face`.
  [[nodiscard]] bool same_solid(std::uint32_t face, std::uint32_t other) const;
  void find_cavities();
  void bound_normals();

  const sites::SitesData& sites_;
  double least_turn_;                       ///< n·(outward normal) of a face that stops the ball is above it
  double ray_turn_;                         ///< the same of a face that ends the ray, at any angle
  double back_;                             ///< rays start so far outside of a face
  std::vector<Vec3> outward_;               ///< of each face, of length 1; 0 without an area
  std::vector<std::uint8_t> cavity_;        ///< of each shell
  std::vector<tree::FloatBox> directions_;  ///< of the outward normals below each node of the tree
};

/// Where the ray or the ball of a sample ends.
struct WallEnd {
  double thickness = std::numeric_limits<double>::infinity();
  Vec3 point{};
  std::uint32_t face = kNone;
};

/// Searches from the samples of one face after another. At most one per thread at a time.
class WallSearch {
 public:
  explicit WallSearch(const Walls& walls) : walls_(walls) {}

  /// Finds rays() of these points of a face that is measured.
  void start(std::uint32_t face, std::span<const Vec3> points);
  [[nodiscard]] std::span<const WallEnd> rays() const { return ends_; }
  /// The ball at a point of start(), given the end of its ray. Of consecutive points that are close together,
  /// the ball of the last one bounds the search.
  [[nodiscard]] WallEnd ball(const Vec3& point, const WallEnd& ray);

 private:
  void stop(const Touching& ball, std::uint32_t face, Reached& least);

  const Walls& walls_;
  std::uint32_t face_ = kNone, stopped_by_ = kNone;
  rays::Scratch scratch_;
  std::vector<Ray> starts_;
  std::vector<RayHit> hits_;
  std::vector<WallEnd> ends_;
};

}  // namespace sdm::thickness
