// The largest covering radius, without storing pieces and samples.
#include <sdm/sampling_bound.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>

#include "core/atomic_extremes.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "surface/sampling_bound/face_cutter.h"
#include "surface/sampling_bound/piece_assignment.h"

namespace sdm {
namespace surface {
namespace {

/// The radius of the pieces of one face. A part of the face that is surely within the largest radius so far
/// need not be cut. That depends on the order of the faces, but the result does not.
class LargestRadius {
 public:
  LargestRadius(const Surface& surface, std::uint32_t face, double& largest)
      : surface_(surface),
        frame_(surface.mesh(), face),
        rounding_(frame_.rounding()),
        square_(surface.face_charts()[face] == kNone ? 0 : square_radius(surface, face, frame_)),
        shared_(largest) {}

  // Whether all pieces of a face with few squares are surely within the largest radius: those of its squares
  // whose texels have an owner. Most faces need no more than this, which cuts nothing.
  [[nodiscard]] bool skips_face(std::uint32_t face) const {
    constexpr double kMostSquares = 256;
    const double least = least_to_know();
    if (surface_.face_charts()[face] == kNone || !(square_ <= least)) return false;
    const auto& corners = internals(surface_).corners[face];
    const auto [x0, x1] = std::minmax({corners[0][0], corners[1][0], corners[2][0]});
    const auto [y0, y1] = std::minmax({corners[0][1], corners[1][1], corners[2][1]});
    const double left = std::floor(x0), top = std::floor(y0), n = surface_.resolution();
    if (!(left >= 0 && top >= 0 && x1 < n && y1 < surface_.rows())) return false;
    if ((x1 - left + 1) * (y1 - top + 1) > kMostSquares) return false;
    const SurfaceData& data = internals(surface_);
    const auto owners = surface_.texel_faces();
    const double spare = least - square_;
    for (double y = top; y <= y1; ++y)
      for (double x = left; x <= x1; ++x) {
        const auto texel = static_cast<std::uint32_t>(y * n + x);
        if (owners[texel] == face) continue;
        if (owners[texel] == kNone) return false;
        const Vec2 at{x + 0.5, y + 0.5};
        const Vec3 centre = data.to_surface(face, at) - data.to_surface(owners[texel], at);
        if (squared_norm(centre) > spare * spare) return false;
      }
    return true;
  }

  [[nodiscard]] double enough(const CutFace& face) const { return std::max(face.enough, least_to_know()); }

  // The square of the texel on the face's plane, which contains the part of the face, is a parallelogram: no
  // point of it is farther from the sample than a corner.
  [[nodiscard]] bool skips(const CutFace& face, double x, double y, std::uint32_t texel) const {
    const double least = least_to_know();
    if (texel == kNone) return false;
    if (surface_.texel_faces()[texel] == face.index) return square_ <= least;
    const auto& [du, dv] = internals(surface_).maps[face.index].edges;
    const Vec3 centre = surface_.to_surface(face.index, {x + 0.5, y + 0.5}) - surface_.texel_point(texel);
    double squared = 0;
    for (const double a : {-0.5, 0.5})
      for (const double b : {-0.5, 0.5}) squared = std::max(squared, squared_norm(centre + a * du + b * dv));
    // square_ contains the rounding error of the parallelogram.
    const double error = square_ - half_diagonal({du, dv});
    return std::sqrt(squared) + error <= least;
  }
  void take_whole_square(const CutFace&, std::uint32_t) { take(square_); }
  void take_piece(const CutFace& face, const Polygon& polygon, std::uint32_t texel) {
    take(Outline(face.vertices, polygon).farthest_from(surface_.texel_point(texel)) + rounding_);
  }

 private:
  // Radii up to this do not change the result.
  [[nodiscard]] double least_to_know() const {
    return std::atomic_ref(shared_).load(std::memory_order_relaxed) - rounding_;
  }
  void take(double radius) { atomic_max(shared_, radius); }

  const Surface& surface_;
  const FaceFrame frame_;
  const double rounding_, square_;
  double& shared_;
};

double largest_radius(const Surface& surface) {
  const FaceCutter cutter(surface);
  const std::size_t faces = surface.mesh().triangles.size();
  double largest = 0;
  parallel_for(faces, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (is_removed(surface.mesh().triangles[f])) continue;
      LargestRadius radius(surface, static_cast<std::uint32_t>(f), largest);
      if (!radius.skips_face(static_cast<std::uint32_t>(f)))
        cutter.cut(static_cast<std::uint32_t>(f), radius);
    }
  });
  return rounded_up(largest);
}

}  // namespace
}  // namespace surface

double covering_radius(const Surface& surface) try {
  return surface::largest_radius(surface);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the covering radius of the atlas");
}

}  // namespace sdm
