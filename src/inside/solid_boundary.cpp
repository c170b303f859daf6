#include "inside/solid_boundary.h"

#include <algorithm>

#include "core/cancellation.h"
#include "core/parallel.h"
#include "geometry/clip.h"
#include "geometry/point_triangle.h"
#include "inside/near_faces.h"
#include "inside/solid.h"
#include "search/branch_and_bound.h"

namespace sdm::inside {
namespace {

// Lengths in the unit frame. Faces nearer to a plane than kFlat lie in it. kBeside is less than kClearance,
// so that no face lies between a piece that is clear of others and a point at this distance, and more than
// kFlat.
constexpr double kFlat = 1e-7, kBeside = 1e-6;
// Pieces that are thinner are not divided, and those thinner than kThinnest are ignored.
constexpr double kThin = 1e-5, kThinnest = 1e-9;
// A piece that more planes cut is divided into smaller ones first, unless its sides are shorter than kFinest;
// one that more than kMostCuts cut is not divided.
constexpr std::size_t kFewCuts = 6, kMostCuts = 24;
constexpr double kFinest = 2e-3;
constexpr std::size_t kGrain = 256;
// A winding number takes as long as some comparisons of two triangles, and one for each face nearby.
constexpr std::size_t kWorkOfEachCell = 16;

// Whether `piece` lies in triangle t: in its plane, and within its sides.
bool covers(const Corners& t, const Corners& piece) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const double size = norm(normal);
  if (size == 0) return false;
  for (const Vec3& p : piece) {
    if (std::abs(dot(normal, p - t[0])) > kFlat * size) return false;
    for (int k = 0; k < 3; ++k) {
      const Vec3 side = t[(k + 1) % 3] - t[k];
      if (dot(cross(normal, side), p - t[k]) < -kFlat * size * norm(side)) return false;
    }
  }
  return true;
}

bool finest(const Corners& t) {
  return squared_norm(t[1] - t[0]) < kFinest * kFinest && squared_norm(t[2] - t[1]) < kFinest * kFinest &&
         squared_norm(t[0] - t[2]) < kFinest * kFinest;
}

// A convex polygon in a plane.
using Polygon = std::vector<Vec3>;

Vec3 mean(const Polygon& polygon) {
  Vec3 sum{};
  for (const Vec3& p : polygon) sum = sum + p;
  return (1.0 / static_cast<double>(polygon.size())) * sum;
}

// An upper bound on the width: twice the area by the longest side or diagonal from the first corner.
double width(const Polygon& polygon) {
  double area = 0, longest = 0;
  for (std::size_t i = 1; i < polygon.size(); ++i) {
    longest = std::max({longest, norm(polygon[i] - polygon[0]), norm(polygon[i] - polygon[i - 1])});
    if (i > 1) area += norm(cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]));
  }
  return longest > 0 ? area / longest : 0;
}

// Cuts off what is above the plane, and returns it; neither part is thinner than kThinnest.
template <class Plane>
Polygon cut(Polygon& polygon, const Plane& plane) {
  thread_local std::vector<double> height;
  height.clear();
  double least = 0, most = 0;
  for (const Vec3& p : polygon) {
    const double h = plane.height(p);
    height.push_back(std::abs(h) <= kThinnest ? 0 : h);
    least = std::min(least, height.back());
    most = std::max(most, height.back());
  }
  if (least == 0 || most == 0) return {};
  const auto side = [&] {
    Polygon part;
    clip_convex(
        height, [&](std::size_t i) { part.push_back(polygon[i]); },
        [&](std::size_t i, std::size_t j, double t) {
          part.push_back(polygon[i] + t * (polygon[j] - polygon[i]));
        });
    return part;
  };
  Polygon above = side();
  for (double& h : height) h = -h;
  polygon = side();
  return above;
}

}  // namespace

struct SolidBoundary::Plane {
  Vec3 point, normal;

  [[nodiscard]] double height(const Vec3& p) const { return dot(normal, p - point); }
  [[nodiscard]] bool cuts(const Corners& t) const {
    return std::ranges::any_of(t, [&](const Vec3& p) { return height(p) < -kThinnest; }) &&
           std::ranges::any_of(t, [&](const Vec3& p) { return height(p) > kThinnest; });
  }
  [[nodiscard]] bool equals(const Plane& other) const {
    return std::abs(height(other.point)) < kFlat && squared_norm(cross(normal, other.normal)) < kFlat * kFlat;
  }
};

// Quarters of a long one would be as thin, and many of them cross whatever crosses one.
void SolidBoundary::Piece::append_parts(std::vector<Piece>& parts) const {
  constexpr double kLong = 4;  // its longest side by its height
  std::array<Vec3, 3> middle;  // of each side
  std::array<double, 3> side;  // squared
  for (int k = 0; k < 3; ++k) {
    middle[k] = 0.5 * (at[k] + at[(k + 1) % 3]);
    side[k] = squared_norm(at[(k + 1) % 3] - at[k]);
  }
  const auto k = static_cast<int>(std::ranges::max_element(side) - side.begin());
  if (side[k] > kLong * norm(cross(at[1] - at[0], at[2] - at[0]))) {
    const int next = (k + 1) % 3, last = (k + 2) % 3;
    parts.push_back({face, {at[k], middle[k], at[last]}});
    parts.push_back({face, {middle[k], at[next], at[last]}});
    return;
  }
  for (int i = 0; i < 3; ++i) parts.push_back({face, {at[i], middle[i], middle[(i + 2) % 3]}});
  parts.push_back({face, middle});
}

int SolidBoundary::Windings::of(const sites::SitesData& solid, const Vec3& point) {
  constexpr double kNear = 0.1;  // in the unit frame: shorter than most ways out of the box
  std::optional<int> turns;
  if (known_ && norm(point - last_) * solid.frame.scale < kNear)
    if ((turns = crossings(solid, rays::Segment{point, last_}))) *turns += number_;
  known_ = true;
  last_ = point;
  return number_ = turns ? *turns : winding(solid, point);
}

SolidBoundary::SolidBoundary(const sites::SitesData& solid, const FaceSides& sides)
    : solid_(solid),
      sides_(solid.mesh.triangles.size()),
      mixed_number_(sides_.size(), kNone),
      beside_(sides.offset()) {
  const Array<std::uint32_t>& faces = solid.tree.items;  // neighbours one after another
  parallel_for(faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) sides_[faces[i]] = sides.of_face(faces[i]);
  });
  std::vector<std::uint32_t> mixed;
  for (const std::uint32_t face : faces)
    if (sides_[face] == Sides::mixed) {
      mixed_number_[face] = static_cast<std::uint32_t>(mixed.size());
      mixed.push_back(face);
    }
  mixed_ = std::make_unique<MixedFace[]>(mixed.size());
  parallel_for(mixed.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) find_near_faces(solid, mixed[i], mixed_[i].near);
  });
}

SolidBoundary::Piece SolidBoundary::whole_face(std::uint32_t face) const {
  const Sides sides = sides_[face];
  return {face, unit_corners(solid_, face), sides == Sides::mixed ? Sides::unknown : sides};
}

bool SolidBoundary::find_cuts(const Piece& piece, std::span<const std::uint32_t> faces, std::size_t most,
                              std::vector<Plane>& cuts) const {
  const Vec3& normal = solid_.normals.face[piece.face];
  bool covered = false;
  cuts.clear();
  const auto add = [&](const Plane& plane) {
    // Planes beside the piece, such as those of the far sides of coincident faces, do not divide it.
    if (plane.cuts(piece.at) &&
        std::ranges::none_of(cuts, [&](const Plane& known) { return known.equals(plane); }))
      cuts.push_back(plane);
  };
  for (const std::uint32_t other : faces) {
    if (cuts.size() > most) break;
    const Corners t = unit_corners(solid_, other);
    if (std::ranges::all_of(t,
                            [&](const Vec3& p) { return std::abs(dot(normal, p - piece.at[0])) < kFlat; })) {
      covered = true;
      for (int k = 0; k < 3; ++k)
        if (const Vec3 wall = cross(normal, t[(k + 1) % 3] - t[k]); norm(wall) > 0)
          add({t[k], normalized(wall)});
    } else if (const Vec3 own = cross(t[1] - t[0], t[2] - t[0]); norm(own) > 0) {
      add({t[0], normalized(own)});
    }
  }
  return covered;
}

// The cells between the planes have the same sides everywhere.
void SolidBoundary::divide(const Piece& piece, std::span<const std::uint32_t> near, Windings& windings,
                           Division& division) const {
  poll();
  division.known = true;
  division.pieces.clear();
  division.near.clear();
  for (const std::uint32_t other : near)
    if (!apart(piece.at, unit_corners(solid_, other))) division.near.push_back(other);
  division.work = near.size() + division.near.size();
  std::vector<Plane> cuts;
  const std::size_t most = finest(piece.at) ? kMostCuts : kFewCuts;
  const bool covered = find_cuts(piece, division.near, most, cuts), too_many = cuts.size() > most;
  if (too_many && !finest(piece.at)) {
    piece.append_parts(division.pieces);
    return;
  }
  std::vector<Polygon> cells{{piece.at.begin(), piece.at.end()}};
  if (!too_many)
    for (const Plane& plane : cuts)
      for (std::size_t i = 0, count = cells.size(); i < count; ++i)
        if (Polygon above = cut(cells[i], plane); !above.empty()) cells.push_back(std::move(above));
  division.work += cells.size() * (cuts.size() + kWorkOfEachCell + division.near.size());
  for (const Polygon& cell : cells) {
    const double thickness = width(cell);
    if (thickness < kThinnest) continue;
    Sides sides = Sides::mixed;
    if (!too_many && !(covered && thickness < kThin))
      sides = sides_beside(mean(cell), piece.face, covered, windings);
    if (sides == Sides::buried) continue;
    for (std::size_t i = 2; i < cell.size(); ++i)
      division.pieces.push_back({piece.face, {cell[0], cell[i - 1], cell[i]}, sides});
  }
}

const SolidBoundary::Division& SolidBoundary::divide(const Piece& piece, MixedFace& face) const {
  Division division = std::move(face.parts[piece.number].division);
  if (!division.known) {
    const std::uint32_t whole = face.parts[piece.number].whole;
    divide(piece, whole == kNone ? face.near : face.parts[whole].division.near, face.windings, division);
    for (Piece& part : division.pieces)
      if (part.sides == Sides::unknown) {
        part.number = static_cast<std::uint32_t>(face.parts.size());
        face.parts.emplace_back().whole = piece.number;
      }
  }
  return face.parts[piece.number].division = std::move(division);
}

bool SolidBoundary::is_inside(const Vec3& point) const {
  return winding(solid_, from_unit(point)) != 0;
}

Sides SolidBoundary::sides_beside(const Vec3& point, std::uint32_t face, bool covered,
                                  Windings& windings) const {
  const Vec3& outwards = solid_.normals.face[face];
  if (!covered && beside_ > 0)
    return sides_by_winding(windings.of(solid_, from_unit(point) + beside_ * outwards));
  // Points at kBeside > kFlat on either side have all faces between them that coincide.
  const bool outer = windings.of(solid_, from_unit(point + kBeside * outwards)) != 0,
             inner = windings.of(solid_, from_unit(point - kBeside * outwards)) != 0;
  return outer == inner ? Sides::buried : inner ? Sides::boundary : Sides::reversed;
}

bool SolidBoundary::repeats_earlier_face(const Piece& piece, std::span<const std::uint32_t> near) const {
  return std::ranges::any_of(near, [&](std::uint32_t other) {
    return other < piece.face && !apart(piece.at, unit_corners(solid_, other)) &&
           covers(unit_corners(solid_, other), piece.at);
  });
}

// Finds the largest −distance from a point q to a part of the boundary, in the unit frame. Parts are nodes of
// the tree, and pieces of faces.
class SolidBoundary::ClosestSearch : public search::Policy {
 public:
  struct Part {
    double upper = 0;  // −distance
    std::uint32_t node = kNone;
    Piece piece{};
    Vec3 point{};  // the closest one of the piece
  };
  struct Found {
    bool boundary = false;
    double beside = 0;  // how far from the point
  };
  using Parts = search::Parts<Part, Found>;

  ClosestSearch(const SolidBoundary& boundary, const Vec3& q, Parts& parts)
      : boundary_(boundary), solid_(boundary.solid_), q_(q), parts_(parts) {}

  // Bounds in the unit frame.
  Closest operator()() {
    // Beyond the box there is no solid, so the boundary is met on the way out.
    closest_.upper = kInfinity;
    const tree::FloatBox& box = solid_.tree.box(0);
    for (int k = 0; k < 3; ++k)
      for (const double end : {double{box.lower[k]}, double{box.upper[k]}})
        closest_.upper = std::min(closest_.upper, std::abs(end - q_[k]) + 2 * kBeside);
    parts_.start(-closest_.upper, 0);
    put_node(0);
    search::branch_and_bound(*this, parts_);
    closest_.lower = std::min(-parts_.upper(), closest_.upper);
    return closest_;
  }

  [[nodiscard]] bool within_budget() const { return !closest_.point && pieces_ <= kMostPieces; }

  // Nodes, and pieces whose sides are unknown.
  bool expand(const Part& part) {
    if (part.node != kNone) {
      const tree::AabbTree::Node& node = solid_.tree.nodes[part.node];
      if (!node.leaf()) {
        put_node(part.node + 1);
        put_node(node.right);
      } else {
        for (const std::uint32_t face : solid_.tree.items_of(part.node))
          if (boundary_.sides_[face] != Sides::buried && !solid_.sliver[face])
            put_piece(boundary_.whole_face(face));
      }
      return true;
    }
    if (part.piece.sides != Sides::unknown) return false;
    if (++pieces_ > kMostPieces) {
      parts_.settle(part.upper);
      return true;
    }
    MixedFace& face = boundary_.mixed(part.piece.face);
    const std::lock_guard lock(face.mutex);
    for (const Piece& piece : boundary_.divide(part.piece, face).pieces) put_piece(piece);
    return true;
  }

  void evaluate(std::span<const Part> run, Found& found) const {
    const Part& part = run[0];
    found = {.boundary = true};
    if (part.piece.sides != Sides::mixed) return;
    const Vec3 beside = kBeside * normalized(part.point - q_);
    found.beside = kBeside;
    // If nothing nearer may be boundary, this side is inside.
    found.boundary =
        !boundary_.is_inside(part.point + beside) && !(unsure_ && !boundary_.is_inside(part.point - beside));
  }

  static void learn(std::span<const Part> /*run*/, const Found& /*found*/) {}

  void conclude(std::span<const Part> run, const Found& found) {
    parts_.settle(run[0].upper);
    unsure_ = unsure_ || !found.boundary;
    if (!found.boundary) return;
    closest_ = {.upper = found.beside - run[0].upper,
                .point = solid_.frame.origin + (1 / solid_.frame.scale) * run[0].point,
                .face = run[0].piece.face};
  }

 private:
  static constexpr std::size_t kMostPieces = 2000;

  void put_node(std::uint32_t node) {
    parts_.put({.upper = -norm(gap(solid_.tree.box(node), q_)), .node = node});
  }
  void put_piece(const Piece& piece) {
    const Vec3 c = closest_on_triangle(q_, piece.at);
    parts_.put({.upper = -norm(c - q_), .piece = piece, .point = c});
  }

  const SolidBoundary& boundary_;
  const sites::SitesData& solid_;
  const Vec3 q_;
  Parts& parts_;
  Closest closest_;
  std::size_t pieces_ = 0;
  bool unsure_ = false;  // whether what is nearer may be boundary
};

SolidBoundary::Closest SolidBoundary::closest(const Vec3& p) const {
  thread_local ClosestSearch::Parts parts;  // reuses its memory
  const Closest found = ClosestSearch(*this, solid_.frame.to_unit(p), parts)();
  const double unit = 1 / solid_.frame.scale;
  return {unit * found.lower, unit * found.upper, found.point, found.face};
}

}  // namespace sdm::inside
