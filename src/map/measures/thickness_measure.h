// The thickness of a solid at a point of its surface, and as a measure.
#pragma once

#include <sdm/measure.h>
#include <sdm/rays.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "map/measure.h"
#include "map/measures/near_walls.h"
#include "map/measures/touching_ball.h"
#include "rays/trace.h"
#include "sites/sites_data.h"

namespace sdm::thickness {

/// The walls of a solid: data that all searches share.
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

/// The end of the ray or the ball of a sample.
struct WallEnd {
  double thickness = kInfinity;
  Vec3 point{};
  std::uint32_t face = kNone;
};

/// Searches from one sample after another; it costs less if they are near each other. At most one per thread
/// at a time.
class WallSearch {
 public:
  explicit WallSearch(const Walls& walls) : walls_(walls) {}

  /// The end of the ray, or of the ball, that starts at a point of a face that is measured.
  [[nodiscard]] WallEnd ray(std::uint32_t face, const Vec3& point);
  [[nodiscard]] WallEnd ball(std::uint32_t face, const Vec3& point);

 private:
  /// The faces that a ball has met.
  struct Stops;

  const Walls& walls_;
  std::uint32_t hit_ = kNone;  ///< by the ray before
  /// The faces that stopped balls before bound the search.
  std::array<std::uint32_t, 4> stopped_by_{kNone, kNone, kNone, kNone};
  std::size_t next_ = 0;  ///< of these, to be replaced
  rays::Scratch scratch_;
};

class ThicknessMeasure final : public map::FaceMeasure {
 public:
  /// All must outlive this. Throws sdm::Error for options that do not apply.
  ThicknessMeasure(const Mesh& mesh, const Sites& sites, const ThicknessOptions& options);

  [[nodiscard]] std::unique_ptr<map::FaceSearch> search() const override;

 private:
  Walls walls_;
  ThicknessMethod method_;
};

}  // namespace sdm::thickness
