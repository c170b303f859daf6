// The thickness of a solid at a point of its surface.
#pragma once

#include <sdm/rays.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "map/thickness/near_walls.h"
#include "map/thickness/touching_ball.h"
#include "rays/trace.h"
#include "sites/sites_data.h"

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
  void arrange_normals();

  const sites::SitesData& sites_;
  double least_turn_;                 ///< n·(outward normal) of a face that stops the ball is above it
  double ray_turn_;                   ///< the same of the face that ends the ray, and stops the ball there
  double back_;                       ///< rays start so far outside of a face
  std::vector<Vec3> outward_;         ///< of each face, of length 1; 0 without an area
  std::vector<std::uint8_t> cavity_;  ///< of each shell
  WallNormals normals_;
};

/// Where the ray or the ball of a sample ends.
struct WallEnd {
  double thickness = std::numeric_limits<double>::infinity();
  Vec3 point{};
  std::uint32_t face = kNone;
};

/// Searches from one sample after another; it costs less if they are near each other. At most one per thread
/// at a time.
class WallSearch {
 public:
  explicit WallSearch(const Walls& walls) : walls_(walls) {}

  /// Where the ray or the ball ends that starts at a point of a face that is measured.
  [[nodiscard]] WallEnd ray(std::uint32_t face, const Vec3& point);
  [[nodiscard]] WallEnd ball(std::uint32_t face, const Vec3& point);

 private:
  /// What a ball has met.
  struct Stops;

  const Walls& walls_;
  std::uint32_t hit_ = kNone;  ///< by the ray before
  /// What has stopped balls before bounds the search.
  std::array<std::uint32_t, 4> stopped_by_{kNone, kNone, kNone, kNone};
  std::size_t next_ = 0;  ///< of these, to be replaced
  rays::Scratch scratch_;
};

}  // namespace sdm::thickness
