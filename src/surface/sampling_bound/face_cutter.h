// Cuts faces along the squares of the texels, and finds a sample near each piece. Any sample gives a valid
// radius; a near one gives a small radius, now and after the surface has deformed. Where a face owns a
// square, the sample is the square's centre.
#pragma once

#include <sdm/surface.h>

#include <algorithm>
#include <array>
#include <span>

#include "geometry/clip.h"
#include "surface/sampling_bound/sample_tree.h"
#include "surface/surface_data.h"

namespace sdm::surface {

/// A convex polygon within a triangle of the atlas. Each corner stores its atlas coordinates and its weights:
/// the point is vertex 0 + weights[0] (vertex 1 − vertex 0) + weights[1] (vertex 2 − vertex 0), wherever the
/// vertices are. Weights are carried along where corners are cut, so that slivers need no inverse map.
class Polygon {
 public:
  struct Corner {
    Vec2 at, weights;
  };

  /// Clipping by a line adds one corner, or at most n/2 where rounding has made n corners slightly
  /// non-convex. Four lines turn three corners into at most 13.
  static constexpr std::size_t kMostCorners = 13;

  explicit Polygon(const std::array<Vec2, 3>& triangle) {
    add({triangle[0], {0, 0}});
    add({triangle[1], {1, 0}});
    add({triangle[2], {0, 1}});
  }

  [[nodiscard]] std::span<const Corner> corners() const { return {corners_.data(), count_}; }
  [[nodiscard]] bool empty() const { return count_ == 0; }

  /// The part where side · (at[axis] − line) ≥ 0; side is 1 or −1. The coordinate of new corners along the
  /// axis is that of the line, bit-identical.
  [[nodiscard]] Polygon clipped(int axis, double line, double side) const {
    std::array<double, kMostCorners> height;
    for (std::size_t i = 0; i < count_; ++i) height[i] = side * (corners_[i].at[axis] - line);
    Polygon part;
    clip_convex(
        {height.data(), count_}, [&](std::size_t i) { part.add(corners_[i]); },
        [&](std::size_t i, std::size_t j, double t) {
          const Corner &a = corners_[i], &b = corners_[j];
          Corner cut{a.at + t * (b.at - a.at), a.weights + t * (b.weights - a.weights)};
          cut.at[axis] = line;
          part.add(cut);
        });
    return part;
  }
  [[nodiscard]] Polygon between(int axis, double lo, double hi) const {
    return clipped(axis, lo, 1).clipped(axis, hi, -1);
  }

  /// The extent along an axis.
  [[nodiscard]] std::array<double, 2> range(int axis) const {
    const auto [lo, hi] = std::ranges::minmax(corners(), {}, [axis](const Corner& c) { return c.at[axis]; });
    return {lo.at[axis], hi.at[axis]};
  }
  /// The extent along the other axis of the points on a line of this axis, along which the polygon was
  /// clipped; lo > hi if there are none.
  [[nodiscard]] std::array<double, 2> range_on(int axis, double line) const {
    double lo = kInfinity, hi = -lo;
    for (const Corner& c : corners())
      if (c.at[axis] == line) {
        lo = std::min(lo, c.at[1 - axis]);
        hi = std::max(hi, c.at[1 - axis]);
      }
    return {lo, hi};
  }

 private:
  Polygon() = default;
  void add(const Corner& corner) { corners_[count_++] = corner; }

  std::array<Corner, kMostCorners> corners_;
  std::size_t count_ = 0;
};

/// The corners of a square [x, x + 1] × [y, y + 1] that lie in a triangle.
struct SquareCorners {
  bool upper_left, upper_right, lower_left, lower_right;

  /// Whether there is an end of each diagonal. The part of the square in the triangle then extends half the
  /// longer diagonal from the centre, and no farther, under any affine map. This is so wherever a single line
  /// clips the square and the centre remains.
  [[nodiscard]] bool both_diagonals() const {
    return (upper_left || lower_right) && (upper_right || lower_left);
  }
};

/// Calls visit(x, y, corners, part) for the squares [x, x + 1] × [y, y + 1] that the triangle meets, in rows;
/// part() is the part of the triangle in the square, which may be empty. The parts cover the triangle. Cost:
/// linear in squares.
template <class Visit>
void for_each_square(const std::array<Vec2, 3>& triangle, Visit visit) {
  const Polygon whole(triangle);
  const auto [top, bottom] = whole.range(1);
  double y = std::floor(top);
  do {
    const Polygon row = whole.between(1, y, y + 1);
    if (row.empty()) continue;
    const std::array<double, 2> upper = row.range_on(1, y), lower = row.range_on(1, y + 1);
    const auto within = [](const std::array<double, 2>& range, double x) {
      return range[0] <= x && x <= range[1];
    };
    const auto [left, right] = row.range(0);
    double x = std::floor(left);
    do
      visit(x, y,
            SquareCorners{within(upper, x), within(upper, x + 1), within(lower, x), within(lower, x + 1)},
            [&] { return row.between(0, x, x + 1); });
    while (++x < right);
  } while (++y < bottom);
}

/// The corners of a polygon in space.
class Outline {
 public:
  Outline(const std::array<Vec3, 3>& vertices, const Polygon& polygon);

  [[nodiscard]] Vec3 middle() const;
  /// The largest distance from s to any of its points: that of a corner, as |p − s| is convex in p.
  [[nodiscard]] double farthest_from(const Vec3& s) const;

 private:
  std::array<Vec3, Polygon::kMostCorners> corners_;
  std::size_t count_ = 0;
};

/// Chooses samples for pieces. Samples around the piece in the atlas will move along with it; near a seam,
/// the nearest sample in space may be closer.
class NearSamples {
 public:
  /// `radius` is about half a texel's diagonal. The surface must outlive this. Cost: linear in samples.
  NearSamples(const Surface& surface, double radius)
      : surface_(surface),
        // A few texels, so that runs that jump to another chart are cut.
        tree_(surface, 16 * radius) {}

  struct Choice {
    std::uint32_t texel = kNone;  ///< the texel of the sample
    double distance = kInfinity;  ///< of the outline's farthest corner
  };
  /// Returns, for a piece of the face in the square of the texel at (x, y), the first sample found within
  /// `enough`, otherwise the nearest. `own`: the sample of a face without a texel, else kNone.
  [[nodiscard]] Choice choose(std::uint32_t face, std::uint32_t own, double x, double y,
                              const Outline& outline, double enough) const;
  /// The texel of the sample nearest to a piece of a face that is not in the atlas.
  [[nodiscard]] std::uint32_t nearest_texel(const Outline& outline) const {
    return surface_.sample_texels()[tree_.nearest(outline.middle())];
  }

  /// The texel whose square has its upper left corner at (x, y), if a face owns it, else kNone.
  [[nodiscard]] std::uint32_t texel_at(double x, double y) const;

 private:
  [[nodiscard]] bool same_side(std::uint32_t face, std::uint32_t other) const;

  const Surface& surface_;
  const SampleTree tree_;
};

/// A face to be cut.
struct CutFace {
  std::uint32_t index;
  std::array<Vec3, 3> vertices;
  double enough;      ///< a distance from a piece to its sample that needs no improvement
  std::uint32_t own;  ///< the sample of a face that owns no texel, else kNone
};

/// A triangle in the plane that represents a face without area: its base is the face's longest edge, as many
/// squares long as the face should have pieces of this length.
[[nodiscard]] std::array<Vec2, 3> unfolded(const std::array<Vec3, 3>& vertices, double piece_length);

/// Cost of cutting: linear in the squares that a face meets.
class FaceCutter {
 public:
  /// The surface must outlive this.
  explicit FaceCutter(const Surface& surface);

  /// Cuts a face and calls, for each square that it meets, one of
  ///
  ///     sink.take_whole_square(face, texel)            the face owns the square, and contains an end of each
  ///                                                    diagonal
  ///     sink.take_piece(face, polygon, texel)          the part in a square that the face owns
  ///     sink.take_piece(face, polygon, texel)          the part in another square, or pieces of it, with
  ///                                                    the texel of a near sample
  ///
  /// or nothing, if sink.skips(face, x, y, texel) returns true for a square with upper left corner (x, y)
  /// whose texel, kNone if no face owns it, is given. sink.enough(face) is a distance below which no nearer
  /// sample is looked for. Threads may cut faces concurrently.
  template <class Sink>
  void cut(std::uint32_t index, Sink& sink) const;

 private:
  [[nodiscard]] CutFace face(std::uint32_t index) const;
  template <class Sink>
  void cut_face_without_area(const CutFace& face, Sink& sink) const;
  template <class Sink>
  void add_piece(const CutFace& face, const Vec2& square, const Polygon& polygon, int cuts,
                 const NearSamples::Choice& known, Sink& sink) const;

  const Surface& surface_;
  const double typical_;
  const NearSamples near_samples_;
};

template <class Sink>
void FaceCutter::cut(std::uint32_t index, Sink& sink) const {
  const CutFace f = face(index);
  if (surface_.face_charts()[index] == kNone) return cut_face_without_area(f, sink);
  const auto visit = [&](double x, double y, SquareCorners corners, const auto& part) {
    const std::uint32_t texel = near_samples_.texel_at(x, y);
    const bool owned = texel != kNone && surface_.texel_faces()[texel] == index;
    if (owned && corners.both_diagonals()) return sink.take_whole_square(f, texel);
    if (sink.skips(f, x, y, texel)) return;
    const Polygon polygon = part();
    if (polygon.empty()) return;
    if (owned)
      sink.take_piece(f, polygon, texel);
    else
      add_piece(f, {x, y}, polygon, 0, {}, sink);
  };
  for_each_square(internals(surface_).corners[index], visit);
}

template <class Sink>
void FaceCutter::cut_face_without_area(const CutFace& face, Sink& sink) const {
  for_each_square(unfolded(face.vertices, typical_), [&](double, double, SquareCorners, const auto& part) {
    if (const Polygon polygon = part(); !polygon.empty())
      sink.take_piece(face, polygon, near_samples_.nearest_texel(Outline(face.vertices, polygon)));
  });
}

// Adds a piece in the square with this upper left corner, which its face does not own. A piece that is far
// from every sample because it is large is halved. `known`: a sample near the piece.
template <class Sink>
void FaceCutter::add_piece(const CutFace& face, const Vec2& square, const Polygon& polygon, int cuts,
                           const NearSamples::Choice& known, Sink& sink) const {
  constexpr int kMostCuts = 4;
  constexpr std::size_t kMostCorners = 8;  // cutting a polygon of 8 gives at most 12
  const Outline outline(face.vertices, polygon);
  const double enough = sink.enough(face);
  NearSamples::Choice choice =
      near_samples_.choose(face.index, face.own, square[0], square[1], outline, enough);
  if (known.distance < choice.distance) choice = known;
  const bool large = 4 * outline.farthest_from(outline.middle()) > choice.distance;
  if (choice.distance <= enough || !large || cuts == kMostCuts || polygon.corners().size() > kMostCorners)
    return sink.take_piece(face, polygon, choice.texel);
  const auto [left, right] = polygon.range(0);
  const auto [top, bottom] = polygon.range(1);
  const bool wide = right - left > bottom - top;
  const double middle = wide ? 0.5 * (left + right) : 0.5 * (top + bottom);
  for (const double side : {1.0, -1.0})
    if (const Polygon half = polygon.clipped(wide ? 0 : 1, middle, side); !half.empty())
      add_piece(face, square, half, cuts + 1, choice, sink);
}

}  // namespace sdm::surface
