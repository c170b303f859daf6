// Cuts faces along the squares of the texels, and finds a sample near each piece. Any sample gives a valid
// radius; a near one gives a small radius, now and after the surface has deformed. Where a face owns a
// square, the sample is the square's centre.
#pragma once

#include <sdm/surface.h>

#include <vector>

#include "geometry/vec.h"
#include "surface/sampling_bound/near_samples.h"
#include "surface/sampling_bound/piece_assignment.h"
#include "surface/sampling_bound/polygon.h"
#include "surface/surface_data.h"

namespace sdm::surface {

/// What the cutter knows of a face.
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
  ///     sink.take_piece(face, polygon, texel)          the part in another square, perhaps in several
  ///     pieces,
  ///                                                    with the texel of a near sample
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
