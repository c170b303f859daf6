// Lower bounds on the radii, from the true distances of points of the surface to the nearest sample.
#include "core/atomic_extremes.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "surface/sample_blocks.h"
#include "surface/sampling_bound/face_frame.h"
#include "surface/sampling_bound/piece_assignment.h"
#include "surface/sampling_bound/sample_tree.h"
#include "surface/surface_data.h"

namespace sdm::surface {
namespace {

/// The largest distance from the tested points of one face to the nearest sample.
class Farthest {
 public:
  Farthest(std::span<const Vec3> samples, const SampleTree& tree, double distance = 0)
      : samples_(samples), tree_(tree), distance_(distance) {}

  /// `most` is the distance to some sample, an upper bound.
  void look_at(const Vec3& p, double most = std::numeric_limits<double>::infinity()) {
    if (most > distance_) distance_ = std::max(distance_, norm(p - samples_[tree_.nearest(p)]));
  }
  [[nodiscard]] double distance() const { return distance_; }

 private:
  const std::span<const Vec3> samples_;
  const SampleTree& tree_;
  double distance_;
};

/// The weights of the corner of a texel's square that is nearest to the middle of a face: in a large face,
/// the four samples nearest to it are equally far.
std::array<double, 2> middle_corner(const std::array<Vec2, 3>& triangle) {
  const Vec2 a = triangle[1] - triangle[0], b = triangle[2] - triangle[0];
  const Vec2 middle = triangle[0] + (1.0 / 3) * (a + b);
  const Vec2 p = Vec2{std::round(middle[0]), std::round(middle[1])} - triangle[0];
  return {cross(p, b) / cross(a, b), cross(a, p) / cross(a, b)};
}

}  // namespace

std::vector<double> PieceAssignment::radius_lower_bounds(const Surface& surface, double bound) const {
  const SampleTree tree(surface, 16 * bound);
  const std::vector<Vec3> points = surface.sample_points();
  std::vector<double> radii(surface.mesh().triangles.size());
  parallel_for(radii.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (is_removed(surface.mesh().triangles[f])) continue;
      const FaceFrame frame(surface.mesh(), f);
      Farthest farthest(points, tree);
      if (surface.face_charts()[f] != kNone) {
        const auto [a, b] = middle_corner(internals(surface).corners[f]);
        if (a >= 0 && b >= 0 && a + b <= 1) farthest.look_at(frame.at(a, b));
      }
      for (const auto& [a, b] : {std::pair(0, 0), {1, 0}, {0, 1}}) farthest.look_at(frame.at(a, b));
      radii[f] = std::max(0.0, farthest.distance() - frame.rounding());
    }
  });
  parallel_for(block_ends_.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      for_each_face(b, [&](const FaceInBlock& part, auto, std::span<const Piece> pieces) {
        const FaceFrame frame(surface.mesh(), part.face);
        const std::atomic_ref<double> known(radii[part.face]);
        Farthest farthest(points, tree, known.load(std::memory_order_relaxed));
        for (const auto& [sample, weights] : pieces)
          for (int k = 0; k < 4; ++k) {
            const Vec3 corner = frame.at(weights[0][k], weights[1][k]);
            farthest.look_at(corner, norm(corner - points[b * kBlockSize + sample]));
          }
        atomic_max(radii[part.face], farthest.distance() - frame.rounding());
      });
  });
  return radii;
}

}  // namespace sdm::surface
