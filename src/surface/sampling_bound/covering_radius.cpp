// The largest covering radius, without storing pieces and samples.
#include <sdm/sampling_bound.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>

#include "core/atomic_extremes.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "surface/sampling_bound/face_cutter.h"
#include "surface/sampling_bound/piece_assignment.h"

namespace sdm {
namespace surface {
namespace {

// Far more than the rounding errors of atlas coordinates and of places on the edges between them.
constexpr double kMargin = 1e-6;

/// The squares that a triangle inside the atlas, which extends from `left` to `right`, meets in a row: from
/// the first to the last. Both may be one too far, nowhere too near.
std::array<std::uint32_t, 2> columns_in_row(const std::array<Vec2, 3>& corners, double y, double left,
                                            double right) {
  // Between the edges that cross the upper and the lower border of the row, and the corners in it.
  double from = right, to = left;
  for (int k = 0; k < 3; ++k) {
    const Vec2 &a = corners[k], &b = corners[(k + 1) % 3];
    const auto [above, below] = std::minmax(a[1], b[1]);
    if (below < y - kMargin || above > y + 1 + kMargin) continue;
    const double slope = above < below ? (b[0] - a[0]) / (b[1] - a[1]) : 0;
    for (const double line : {std::max(y - kMargin, above), std::min(y + 1 + kMargin, below)}) {
      const double x = a[0] + (line - a[1]) * slope;
      from = std::min(from, x);
      to = std::max(to, x);
    }
    if (above < below) continue;
    from = std::min({from, a[0], b[0]});
    to = std::max({to, a[0], b[0]});
  }
  // Nearly horizontal edges round their places most, but not beyond the ends of the triangle.
  return {static_cast<std::uint32_t>(std::max(from, left) - kMargin),
          static_cast<std::uint32_t>(std::min(to, right) + kMargin)};
}

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

  // Whether all pieces of a face are surely within the largest radius: those of the squares that it meets,
  // if their texels have an owner. Most faces need no more than this, which cuts nothing.
  [[nodiscard]] bool skips_face(std::uint32_t face) const {
    const double least = least_to_know();
    if (surface_.face_charts()[face] == kNone || !(square_ <= least)) return false;
    const SurfaceData& data = internals(surface_);
    const std::array<Vec2, 3>& corners = data.corners[face];
    const auto [left, right] = std::minmax({corners[0][0], corners[1][0], corners[2][0]});
    const auto [top, bottom] = std::minmax({corners[0][1], corners[1][1], corners[2][1]});
    if (!(left >= kMargin && top >= kMargin && right + kMargin < data.resolution &&
          bottom + kMargin < data.rows))
      return false;
    const double spare = least - square_;
    const std::uint32_t* const owners = data.map_faces.data();
    for (auto y = static_cast<std::uint32_t>(top - kMargin); y <= bottom + kMargin; ++y) {
      const auto [from, to] = columns_in_row(corners, y, left, right);
      for (std::uint32_t x = from; x <= to; ++x) {
        const std::uint32_t texel = y * data.resolution + x, owner = owners[texel];
        if (owner == face) continue;
        if (owner == kNone) return false;
        const Vec2 at{x + 0.5, y + 0.5};
        const Vec3 centre = data.to_surface(face, at) - data.to_surface(owner, at);
        if (squared_norm(centre) > spare * spare) return false;
      }
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
