#include "bodies/convex/touching.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "geometry/predicates.h"
#include "geometry/triangle_pair.h"

namespace sdm::convex {
namespace {

constexpr std::size_t kFewFaces = 3, kMostNear = 16;
constexpr double kLeastShape = 64;  // the size of the bodies, relative to the height of a triangle

// A plane through three points, and its side that is outside.
struct Plane {
  Corners points;
  Vec3 normal;  // outwards, of length 1, to rounding
  int outside;  // the orientation of points there

  Plane(const Corners& through, const Vec3& outwards, double size)
      : points(through),
        normal(outwards),
        outside(orientation(points[0], points[1], points[2], points[0] + size * normal)) {}

  // Whether heights of vertices that are `distance` away have errors by the normal of less than a quarter of
  // the margin of Touching, as corners are rounded by less than a thousandth of that.
  [[nodiscard]] bool reliable(double distance) const {
    const Vec3 a = points[1] - points[0], b = points[2] - points[0];
    const double longest = std::max(squared_norm(a), squared_norm(b));
    const double area = squared_norm(cross(a, b));
    return outside != 0 && kLeastShape * kLeastShape * area >= longest * distance * distance;
  }
  [[nodiscard]] double height(const Vec3& p) const { return dot(normal, p - points[0]); }
  // 1 outside, 0 on the plane, −1 inside; exact.
  [[nodiscard]] int side(const Vec3& p) const {
    return outside * orientation(points[0], points[1], points[2], p);
  }
};

class Touching {
 public:
  Touching(const std::array<const ConvexMesh*, 2>& meshes, const pairs::MeshPair& pair, double scale,
           const Simplex& simplex, double rounding)
      : meshes_(meshes), pair_(pair), simplex_(simplex), margin_(rounding) {
    size_ = meshes[0]->size + scale * meshes[1]->size;
    for (int side = 0; side < 2; ++side) find_faces(side);
  }

  std::optional<bool> decide() {
    for (int side = 0; side < 2; ++side)
      for (std::size_t i = 0; i < faces_[side].count; ++i) {
        const std::uint32_t face = faces_[side].number[i];
        if (separates(plane_of(side, face), side)) return false;
      }
    for (std::size_t i = 0; i < faces_[0].count; ++i)
      for (std::size_t j = 0; j < faces_[1].count; ++j)
        if (triangles_intersect(pair_.face1(faces_[0].number[i]), pair_.face2(faces_[1].number[j])))
          return true;
    if (edges_separate()) return false;
    return {};
  }

 private:
  struct Faces {
    std::size_t count = 0;
    std::array<std::uint32_t, kFewFaces> number{};
    std::array<double, kFewFaces> along{};
  };

  [[nodiscard]] Vec3 point(int side, std::uint32_t v) const {
    const Vec3& p = meshes_[side]->points[v];
    return side == 0 ? p : pair_.pose(p);
  }
  // The normal in space, of length 1, outwards.
  [[nodiscard]] Vec3 normal_of(int side, std::uint32_t face) const {
    const Vec3 normal = meshes_[side]->normals[face];
    return side == 0 ? normal : normalized(pair_.pose.linear(normal));
  }
  [[nodiscard]] Plane plane_of(int side, std::uint32_t face) const {
    return {side == 0 ? pair_.face1(face) : pair_.face2(face), normal_of(side, face), size_};
  }

  // Finds the faces at the vertices of the simplex that face the other body most.
  void find_faces(int side) {
    const Vec3 u = side == 0 ? -simplex_.away : simplex_.away;
    Faces& faces = faces_[side];
    for (std::uint32_t i = 0; i < simplex_.count; ++i)
      for (const Spoke& spoke : meshes_[side]->spokes.of(simplex_.vertices[i][side]))
        for (const std::uint32_t face : spoke.faces) {
          const auto end = faces.number.begin() + static_cast<std::ptrdiff_t>(faces.count);
          if (std::find(faces.number.begin(), end, face) != end) continue;
          insert(faces, face, dot(u, normal_of(side, face)));
        }
  }
  static void insert(Faces& faces, std::uint32_t face, double along) {
    std::size_t at = faces.count;
    if (at == kFewFaces) {
      if (along <= faces.along[at - 1]) return;
      --at;
    } else {
      ++faces.count;
    }
    for (; at > 0 && faces.along[at - 1] < along; --at) {
      faces.number[at] = faces.number[at - 1];
      faces.along[at] = faces.along[at - 1];
    }
    faces.number[at] = face;
    faces.along[at] = along;
  }

  // Whether the plane has the other body strictly outside, and its own one nowhere outside.
  [[nodiscard]] bool separates(const Plane& plane, int own) const {
    return plane.reliable(size_) && on_side(plane, 1 - own, 1) && (own == 0 || on_side(plane, own, -1));
  }

  // Whether all vertices of a body are strictly outside for 1, or on or inside for −1. As the body is convex,
  // edges lead from any vertex down to the lowest one, so that those up to any height are connected: from one
  // that is at most the margin high, all up to twice that are reached and compared exactly. Errors of heights
  // are much less than the margin, so all others are on their side.
  [[nodiscard]] bool on_side(const Plane& plane, int side, int wanted) const {
    const ConvexMesh& mesh = *meshes_[side];
    const auto height = [&](std::uint32_t v) { return wanted * plane.height(point(side, v)); };
    std::array<std::uint32_t, kMostNear> near{lowest(side, height)};
    if (const double least = height(near[0]); least > margin_ || least < -margin_) return false;
    std::size_t count = 1;
    for (std::size_t next = 0; next < count; ++next) {
      const int found = wanted * plane.side(point(side, near[next]));
      if (wanted > 0 ? found <= 0 : found < 0) return false;
      for (const Spoke& spoke : mesh.spokes.of(near[next])) {
        const auto end = near.begin() + static_cast<std::ptrdiff_t>(count);
        if (height(spoke.end) > 2 * margin_ || std::find(near.begin(), end, spoke.end) != end) continue;
        if (count == kMostNear) return false;
        near[count++] = spoke.end;
      }
    }
    return true;
  }
  template <class Height>
  [[nodiscard]] std::uint32_t lowest(int side, const Height& height) const {
    std::uint32_t vertex = simplex_.vertices[0][side];
    for (double least = height(vertex);;) {
      const std::uint32_t before = vertex;
      for (const Spoke& spoke : meshes_[side]->spokes.of(before))
        if (const double h = height(spoke.end); h < least) {
          least = h;
          vertex = spoke.end;
        }
      if (vertex == before) return vertex;
    }
  }

  // Whether the plane through an edge of O1 with the direction of one of O2 separates the bodies.
  [[nodiscard]] bool edges_separate() const {
    std::array<std::array<std::uint32_t, 2>, 2> ends{};
    for (int side = 0; side < 2; ++side) {
      ends[side] = {simplex_.vertices[0][side], simplex_.vertices[0][side]};
      for (std::uint32_t i = 1; i < simplex_.count; ++i)
        if (simplex_.vertices[i][side] != ends[side][0]) ends[side][1] = simplex_.vertices[i][side];
      if (ends[side][0] == ends[side][1]) return false;
    }
    const Vec3 a = point(0, ends[0][0]), b = point(0, ends[0][1]);
    const Vec3 along = point(1, ends[1][1]) - point(1, ends[1][0]);
    Vec3 normal = normalized(cross(b - a, along));
    if (dot(normal, simplex_.away) > 0) normal = -normal;
    const Plane plane({a, b, a + along}, normal, size_);
    return plane.reliable(size_) && on_side(plane, 1, 1) && on_side(plane, 0, -1);
  }

  const std::array<const ConvexMesh*, 2> meshes_;
  const pairs::MeshPair& pair_;
  const Simplex& simplex_;
  const double margin_;
  double size_;
  std::array<Faces, 2> faces_;
};

}  // namespace

std::optional<bool> touching(const ConvexMesh& o1, const ConvexMesh& o2, const pairs::MeshPair& pair,
                             double scale, const Simplex& simplex, double rounding) {
  if (simplex.count == 0) return {};
  return Touching({&o1, &o2}, pair, scale, simplex, rounding).decide();
}

}  // namespace sdm::convex
