#include "inside/solid_boundary.h"

#include <algorithm>
#include <limits>

#include "core/geometry/triangle_pair.h"
#include "core/parallel.h"
#include "hierarchy/traverse.h"
#include "inside/solid.h"

namespace sdm::inside {
namespace {

// Lengths in the unit frame. Faces nearer to a plane than kFlat lie in it. kBeside is less than kClearance,
// so that no face lies between a piece that is clear of others and a point at this distance, and more than
// kFlat.
constexpr double kFlat = 1e-7, kBeside = 1e-6;
// Pieces whose sides are shorter are not divided further.
constexpr double kFinest = 2e-3;
constexpr std::size_t kGrain = 256;

Vec3 mean(const Corners& t) {
  return (1.0 / 3) * (t[0] + t[1] + t[2]);
}

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

Vec3 closest_in(const Corners& t, const Vec3& p) {
  return closest_points(t, {p, p, p}).point1;
}

}  // namespace

std::array<SolidBoundary::Piece, 4> SolidBoundary::Piece::divided() const {
  std::array<Vec3, 3> middle;  // of each side
  for (int k = 0; k < 3; ++k) middle[k] = 0.5 * (at[k] + at[(k + 1) % 3]);
  return {Piece{face, {at[0], middle[0], middle[2]}}, Piece{face, {middle[0], at[1], middle[1]}},
          Piece{face, {middle[2], middle[1], at[2]}}, Piece{face, middle}};
}

SolidBoundary::SolidBoundary(const sites::SitesData& solid, const FaceSides& sides)
    : solid_(solid), sides_(solid.mesh.triangles.size()), mixed_number_(sides_.size(), kNone) {
  const std::vector<std::uint32_t>& faces = solid.tree.items;  // neighbours one after another
  parallel_for(faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) sides_[faces[i]] = sides.of_face(faces[i]);
  });
  std::vector<std::uint32_t> mixed;
  for (const std::uint32_t face : faces)
    if (sides_[face] == Sides::mixed) {
      mixed_number_[face] = static_cast<std::uint32_t>(mixed.size());
      mixed.push_back(face);
    }
  near_.resize(mixed.size());
  parallel_for(mixed.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) find_near_faces(solid, mixed[i], near_[i]);
  });
}

SolidBoundary::Piece SolidBoundary::whole_face(std::uint32_t face) const {
  return {face, unit_corners(solid_, face)};
}

Sides SolidBoundary::sides_of(const Piece& piece) const {
  if (sides_[piece.face] != Sides::mixed) return sides_[piece.face];
  if (solid_.sliver[piece.face]) return Sides::mixed;
  for (const std::uint32_t other : near_[mixed_number_[piece.face]]) {
    const Corners t = unit_corners(solid_, other);
    if (!apart(piece.at, t) && !covers(t, piece.at)) return Sides::mixed;
  }
  return sides_beside(mean(piece.at), solid_.normals.face[piece.face]);
}

// By winding numbers on both sides of a point, along a unit vector `outwards`, so that several coincident
// faces are crossed at once.
Sides SolidBoundary::sides_beside(const Vec3& point, const Vec3& outwards) const {
  const auto inside = [&](double offset) {
    const Vec3 p = point + offset * outwards;
    return winding(solid_, {}, solid_.frame.origin + (1 / solid_.frame.scale) * p) != 0;
  };
  const bool outer = inside(kBeside), inner = inside(-kBeside);
  return outer == inner ? Sides::buried : inner ? Sides::boundary : Sides::reversed;
}

bool SolidBoundary::repeats_earlier_face(const Piece& piece) const {
  if (sides_[piece.face] != Sides::mixed) return false;
  const std::vector<std::uint32_t>& near = near_[mixed_number_[piece.face]];
  return std::ranges::any_of(near, [&](std::uint32_t other) {
    return other < piece.face && !apart(piece.at, unit_corners(solid_, other)) &&
           covers(unit_corners(solid_, other), piece.at);
  });
}

SolidBoundary::Closest SolidBoundary::closest(const Vec3& p) const {
  constexpr std::size_t kMostPieces = 2000;
  const Vec3 q = solid_.frame.to_unit(p);
  const double unit = 1 / solid_.frame.scale;
  // What may be nearest: a node of the tree, or part of a face, with a lower bound on its distance.
  struct Open {
    double bound = 0;
    std::uint32_t node = kNone;
    Piece piece{};
    Vec3 point{};
    bool operator<(const Open& other) const { return bound > other.bound; }  // the nearest on top
  };
  thread_local std::vector<Open> heap;
  std::vector<Open>& open = heap;
  open.clear();
  const auto push = [&](const Open& o) {
    open.push_back(o);
    std::push_heap(open.begin(), open.end());
  };
  const auto push_node = [&](std::uint32_t node) {
    push({.bound = norm(gap(solid_.tree.box(node), q)), .node = node});
  };
  const auto push_piece = [&](const Piece& piece) {
    const Vec3 c = closest_in(piece.at, q);
    push({.bound = norm(c - q), .piece = piece, .point = c});
  };
  // Beyond the box there is no solid, so the boundary is met on the way out.
  Closest found{.upper = std::numeric_limits<double>::infinity()};
  const hierarchy::FloatBox& box = solid_.tree.box(0);
  for (int k = 0; k < 3; ++k)
    for (const double end : {double{box.lo[k]}, double{box.hi[k]}})
      found.upper = std::min(found.upper, std::abs(end - q[k]) + 2 * kBeside);
  found.lower = found.upper;
  push_node(0);
  for (std::size_t pieces = 0; !open.empty() && open.front().bound < found.upper;) {
    std::pop_heap(open.begin(), open.end());
    const Open nearest = open.back();
    open.pop_back();
    if (nearest.node != kNone) {
      const hierarchy::AabbTree::Node& node = solid_.tree.nodes[nearest.node];
      if (node.leaf()) {
        for (const std::uint32_t face : solid_.tree.items_of(nearest.node))
          if (sides_[face] != Sides::buried && !solid_.sliver[face]) push_piece(whole_face(face));
      } else {
        push_node(nearest.node + 1), push_node(node.right);
      }
      continue;
    }
    const auto is_boundary = [](Sides sides) { return sides == Sides::boundary || sides == Sides::reversed; };
    const Piece& piece = nearest.piece;
    const bool whole = sides_[piece.face] != Sides::mixed;
    if (whole || is_boundary(sides_beside(nearest.point, normalized(nearest.point - q)))) {
      found.upper = nearest.bound + (whole ? 0 : kBeside);
      found.point = solid_.frame.origin + unit * nearest.point;
      found.face = piece.face;
      found.lower = std::min(found.lower, nearest.bound);
      break;
    }
    if (++pieces > kMostPieces) {
      found.lower = std::min(found.lower, nearest.bound);
      break;
    }
    if (sides_of(piece) == Sides::buried) continue;
    if (finest(piece.at))
      found.lower = std::min(found.lower, nearest.bound);
    else
      for (const Piece& part : piece.divided()) push_piece(part);
  }
  found.lower = std::min(found.lower, found.upper);
  return {unit * found.lower, unit * found.upper, found.point, found.face};
}

SolidBoundary::Volume SolidBoundary::volume() const {
  const std::vector<std::uint32_t>& faces = solid_.tree.items;
  // Six times the volume, and what the parts that may or may not be boundary contribute; in parts that do not
  // depend on the number of threads.
  struct Sum {
    double sure = 0, unsure = 0;
  };
  std::vector<Sum> sums((faces.size() + kGrain - 1) / kGrain);
  parallel_for(sums.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<Piece> open;
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = kGrain * i; k < std::min(kGrain * (i + 1), faces.size()); ++k) {
        open.assign(1, whole_face(faces[k]));
        while (!open.empty()) {
          const Piece piece = open.back();
          open.pop_back();
          const auto& [a, b, c] = piece.at;
          const double flux = dot(a, cross(b, c)) * (solid_.inverted[piece.face] ? -1 : 1);
          const Sides sides = sides_of(piece);
          if (sides != Sides::mixed && repeats_earlier_face(piece)) continue;
          if (sides == Sides::boundary)
            sums[i].sure += flux;
          else if (sides == Sides::reversed)
            sums[i].sure -= flux;
          else if (sides == Sides::mixed && (finest(piece.at) || solid_.sliver[piece.face]))
            sums[i].unsure += std::abs(flux);
          else if (sides == Sides::mixed)
            for (const Piece& part : piece.divided()) open.push_back(part);
        }
      }
  });
  Sum all;
  for (const Sum& sum : sums) all.sure += sum.sure, all.unsure += sum.unsure;
  const double unit = 1 / (6 * solid_.frame.scale * solid_.frame.scale * solid_.frame.scale);
  return {unit * std::max(0.0, all.sure - all.unsure), unit * (all.sure + all.unsure)};
}

}  // namespace sdm::inside
