// The thickness of a solid at a point of its surface, and as a measure.
#pragma once

#include <sdm/measure.h>

#include <cstdint>
#include <span>
#include <vector>

#include "map/measure.h"
#include "map/measures/near_walls.h"
#include "rays/trace.h"
#include "sites/sites_data.h"

namespace sdm::thickness {

/// The walls of a solid: data that all searches share.
class Walls {
 public:
  /// Prepares searches by this method; `angle` in degrees. Throws sdm::Error unless the mesh is closed and
  /// orientable. Cost: linear, all cores.
  Walls(const sites::SitesData& sites, ThicknessMethod method, double angle);

  /// Whether the thickness of a face is defined: it is not ignored, and has an area.
  [[nodiscard]] bool measures(std::uint32_t face) const;
  /// The inward unit normal of a face.
  [[nodiscard]] Vec3 inward(std::uint32_t face) const { return -1.0 * outward_[face]; }
  /// Whether face `other` stops balls that start at `face` and reach it.
  [[nodiscard]] bool stops(std::uint32_t face, std::uint32_t other) const {
    return dot(outward_[other], inward(face)) > least_turn_ && same_solid(face, other);
  }
  /// Whether face `other` can stop anything that starts at `face`.
  [[nodiscard]] bool same_solid(std::uint32_t face, std::uint32_t other) const {
    const std::uint32_t a = component(face), b = component(other);
    return a == b || cavity_[a] != 0 || cavity_[b] != 0;
  }
  /// Two faces of one component can stop the same.
  [[nodiscard]] std::uint32_t component(std::uint32_t face) const {
    return sites_.orientation.component[face];
  }
  /// The outward unit normal of a face; 0 without an area.
  [[nodiscard]] const Vec3& outward(std::uint32_t face) const { return outward_[face]; }
  /// n·(outward normal) of a face that stops a ball with the inward normal n is above it.
  [[nodiscard]] double least_turn() const { return least_turn_; }
  [[nodiscard]] const WallNormals& normals() const { return normals_; }
  [[nodiscard]] const sites::SitesData& sites() const { return sites_; }

 private:
  friend class WallSearch;

  void find_cavities();
  void arrange_normals();
  [[nodiscard]] LeafWalls walls_of_leaf(std::span<const std::uint32_t> faces) const;

  const sites::SitesData& sites_;
  double least_turn_;
  double ray_turn_;                   ///< the same of the face that ends the ray, and stops the ball there
  double back_;                       ///< rays start so far outside of a face
  std::vector<Vec3> outward_;         ///< of each face, of length 1; 0 without an area
  std::vector<std::uint8_t> cavity_;  ///< of each shell
  WallNormals normals_;               ///< for balls
};

/// Searches from one sample after another; it costs less if they are near each other. At most one per thread
/// at a time.
class WallSearch {
 public:
  explicit WallSearch(const Walls& walls) : walls_(walls) {}

  /// The end of the ray that starts here.
  [[nodiscard]] WallEnd ray(const WallStart& start);
  /// Sets the ends of the rays, or of the balls, that start at these samples. Costs less if samples that
  /// follow each other are near each other.
  void measure(ThicknessMethod method, std::span<const WallStart> starts, std::span<WallEnd> ends);

 private:
  void balls(std::span<const WallStart> starts, std::span<WallEnd> ends);

  const Walls& walls_;
  std::uint32_t hit_ = kNone;   ///< by the ray before
  std::vector<WallEnd> known_;  ///< of balls of the packets before
  rays::Scratch scratch_;
  BallMemory memory_;
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
