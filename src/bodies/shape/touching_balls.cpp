#include "bodies/shape/touching_balls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "closest/single_point.h"
#include "geometry/point_triangle.h"
#include "geometry/rounding.h"
#include "search/mixed_bound.h"

namespace sdm::shape {
namespace {

using search::CornerValues;

constexpr double kNoBound = kInfinity;
constexpr int kMostSearches = 48;
// If a ball that is smaller by this fraction touches the boundary, the bound is close enough: closer ones
// take many searches.
constexpr double kClose = 1.0 / 6;
// Corners of a triangle that is enlarged move at most so many times as far as its sides.
constexpr double kFarthest = 32;

// The triangle with its sides moved out in its plane; false if it is too sharp.
bool enlarge(Corners& at, const Vec3& normal, double by) {
  std::array<Vec3, 3> outward;  // of the side from corner k to k + 1
  for (int k = 0; k < 3; ++k) {
    const Vec3 across = normalized(cross(at[(k + 1) % 3] - at[k], normal));
    outward[k] = dot(across, at[(k + 2) % 3] - at[k]) > 0 ? -across : across;
  }
  Corners moved;
  for (int k = 0; k < 3; ++k) {
    const Vec3 &u = outward[k], &v = outward[(k + 2) % 3];
    const double along = 1 + dot(u, v);
    if (!(along * kFarthest > norm(u + v))) return false;
    moved[k] = at[k] + by / along * (u + v);
  }
  at = moved;
  return true;
}

class TouchingBalls {
 public:
  TouchingBalls(const sites::SitesData& solid, const inside::FaceSides& sides,
                const TouchedTriangle& triangle, double most)
      : solid_(solid),
        sides_(sides),
        normal_(triangle.normal),
        cosine_(std::cos(triangle.angle)),
        most_(most) {}

  // The bound for points x′ of a triangle.
  double bound(const Corners& at) {
    pieces_[0] = {.at = at};
    count_ = 1;
    searches_ = 0;
    bound_ = 0;
    while (count_ > 0) {
      Piece piece = pieces_[--count_];
      if (!settle(piece)) return kNoBound;
    }
    return bound_;
  }

 private:
  struct Piece {
    static constexpr std::size_t kMostFaces = 6;
    Corners at{};
    std::array<std::uint32_t, kMostFaces> faces{};
    std::array<CornerValues, kMostFaces> values{};
    std::size_t count = 0;
  };

  // Bounds a piece by the faces that the largest balls meet, or divides it. False if there is no bound.
  bool settle(Piece& piece) {
    for (;;) {
      const auto mixed = search::mixed_bound(std::span(piece.values).first(piece.count), bound_);
      if (mixed.value <= bound_) return true;
      if (++searches_ > kMostSearches) return false;
      const auto& [a, b, c] = piece.at;
      const Vec3 x = mixed.weights[0] * a + mixed.weights[1] * b + mixed.weights[2] * c;
      const double radius = std::min(mixed.value, most_);
      const Vec3 centre = x - radius * cosine_ * normal_;
      const ClosestPoint closest = closest::closest_point(solid_, centre, kNoBound);
      if (closest.distance >= (1 - kClose) * cosine_ * radius) {  // the face itself is as near
        bound_ = mixed.value;
        return bound_ <= most_;
      }
      const std::uint32_t face = solid_.face_of(closest.type, closest.site);
      const inside::Sides sides = sides_.of_face(face);
      if (sides != inside::Sides::boundary && sides != inside::Sides::reversed) return false;
      const auto known = std::span(piece.faces).first(piece.count);
      if (piece.count == Piece::kMostFaces || std::ranges::count(known, face) > 0)
        return divide(piece, mixed.mixed);
      add(piece, face);
    }
  }

  void add(Piece& piece, std::uint32_t face) const {
    const Corners corners = corners_of(solid_.mesh, face);
    CornerValues& values = piece.values[piece.count];
    for (int k = 0; k < 3; ++k)
      values[k] =
          std::max(least_radius(piece.at[k], 1, corners), least_radius(piece.at[k], cosine_, corners));
    if (values[0] + values[1] + values[2] < kNoBound) piece.faces[piece.count++] = face;
  }

  // ρ of a point x, or slightly more: the radius of the ball about x − r c n whose surface the closest point
  // of the face is on. That of any point q of the face is at least ρ; q is taken closest to the centre of the
  // ball before.
  [[nodiscard]] double least_radius(const Vec3& x, double c, const Corners& face) const {
    constexpr int kMostShrinks = 8;
    constexpr double kShrunk = 1e-3;
    const auto radius_of = [&](const Vec3& q) {
      const Vec3 to = x - q;
      const double squared = squared_norm(to), along = c * dot(normal_, to);
      const double divisor = along + std::sqrt(along * along + (1 - c * c) * squared);
      return divisor > 0 ? squared / divisor : kNoBound;
    };
    double radius = kNoBound;
    for (const Vec3& q : face) radius = std::min(radius, radius_of(q));
    if (radius == kNoBound) return radius;
    for (int step = 0; step < kMostShrinks; ++step) {
      const double next = radius_of(closest_on_triangle(x - radius * c * normal_, face));
      if (!(next < (1 - kShrunk) * radius)) break;
      radius = next;
    }
    return radius;
  }

  // Where two of the functions in the mean are equal: on either side, one of them is a bound by itself. If
  // they are not, from the longest side to the corner opposite.
  bool divide(const Piece& piece, const std::array<std::uint32_t, 3>& mixed) {
    Piece parent{.at = piece.at};  // without other functions
    for (const std::uint32_t m : mixed)
      if (m != kNone) {
        parent.faces[parent.count] = piece.faces[m];
        parent.values[parent.count++] = piece.values[m];
      }
    if (parent.count > 1) {
      const CornerValues difference = parent.values[0] - parent.values[1];
      for (int k = 0; k < 3; ++k) {
        const double here = difference[k], next = difference[(k + 1) % 3], last = difference[(k + 2) % 3];
        if (here * next < 0 && here * last < 0)
          return cut(parent, k, here / (here - next), here / (here - last));
      }
    }
    int longest = 0;
    const auto side = [&](int k) { return squared_norm(piece.at[(k + 1) % 3] - piece.at[(k + 2) % 3]); };
    for (int k = 1; k < 3; ++k)
      if (side(k) > side(longest)) longest = k;
    const Vec3 &a = piece.at[longest], &b = piece.at[(longest + 1) % 3], &c = piece.at[(longest + 2) % 3];
    const Vec3 middle = 0.5 * (b + c);
    return push(parent, {a, b, middle}) && push(parent, {a, c, middle});
  }

  // Cuts off corner k, at fractions of the sides from there.
  bool cut(const Piece& piece, int k, double to_next, double to_last) {
    const Vec3 &a = piece.at[k], &b = piece.at[(k + 1) % 3], &c = piece.at[(k + 2) % 3];
    const Vec3 p = a + to_next * (b - a), q = a + to_last * (c - a);
    return push(piece, {a, p, q}) && push(piece, {p, b, c}) && push(piece, {p, c, q});
  }

  bool push(const Piece& from, const Corners& at) {
    if (count_ == pieces_.size()) return false;
    Piece& piece = pieces_[count_++];
    piece = {.at = at};
    for (std::size_t i = 0; i < from.count; ++i) add(piece, from.faces[i]);
    return true;
  }

  const sites::SitesData& solid_;
  const inside::FaceSides& sides_;
  Vec3 normal_;
  double cosine_, most_;
  double bound_ = 0;  // of the pieces that are settled
  int searches_ = 0;
  std::array<Piece, 32> pieces_{};
  std::size_t count_ = 0;
};

}  // namespace

double bound_of_touching_balls(const sites::SitesData& solid, const inside::FaceSides& sides,
                               const TouchedTriangle& triangle, double most) {
  // Points that are deeper than a bound are beside others on the way to their closest point, which are as
  // deep as the enlarged triangle allows: so a bound for that is one for all if it is as wide.
  TouchingBalls balls(solid, sides, triangle, most);
  const double sine = std::sin(triangle.angle);
  constexpr double kSmallAngle = 1e-3;
  double wider = triangle.angle < kSmallAngle ? sine * most : 0;
  for (int turn = 0; turn < 3; ++turn) {
    Corners at = triangle.at;
    if (!enlarge(at, triangle.normal, wider)) break;
    const double bound = balls.bound(at);
    if (bound == kNoBound) break;
    if (bound * sine < wider)
      return bound + kDoubleRounding * (bound + 1 / solid.frame.scale + norm(triangle.at[0]));
    wider = 1.01 * bound * sine + kDoubleRounding / solid.frame.scale;
  }
  return kNoBound;
}

}  // namespace sdm::shape
