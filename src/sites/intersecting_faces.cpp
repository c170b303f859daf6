#include "sites/intersecting_faces.h"

#include <sdm/sites.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <new>
#include <span>

#include "core/cancellation.h"
#include "core/memory.h"
#include "geometry/predicates.h"
#include "geometry/rounding.h"
#include "geometry/triangle_pair.h"
#include "sites/hubs.h"
#include "sites/sites_data.h"

namespace sdm::sites {
namespace {

// The corners of two triangles: first the shared ones, in the same order, then the others.
struct SharedFirst {
  std::array<std::uint32_t, 3> a, b;
  int shared = 0;

  SharedFirst(const Triangle& first, const Triangle& second) : a(first), b(second) {
    for (int i = 0; i < 3; ++i)
      for (int j = shared; j < 3; ++j)
        if (a[i] == b[j]) {
          std::swap(a[shared], a[i]);
          std::swap(b[shared], b[j]);
          ++shared;
          break;
        }
  }
};

bool boxes_apart(const Corners& a, const Corners& b) {
  for (int k = 0; k < 3; ++k)
    if (std::max({a[0][k], a[1][k], a[2][k]}) < std::min({b[0][k], b[1][k], b[2][k]}) ||
        std::max({b[0][k], b[1][k], b[2][k]}) < std::min({a[0][k], a[1][k], a[2][k]}))
      return true;
  return false;
}

bool has_area(const Corners& t) {
  for (int k = 0; k < 3; ++k) {
    const auto flat = [&](const Vec3& p) { return Vec2{p[(k + 1) % 3], p[(k + 2) % 3]}; };
    if (orientation(flat(t[0]), flat(t[1]), flat(t[2])) != 0) return true;
  }
  return false;
}

// Triangles pqa and pqb: whether they lie in one plane, on the same side of pq.
bool folded(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  if (orientation(p, q, a, b) != 0) return false;
  for (int k = 0; k < 3; ++k) {
    const auto flat = [&](const Vec3& v) { return Vec2{v[(k + 1) % 3], v[(k + 2) % 3]}; };
    if (const int side = orientation(flat(p), flat(q), flat(a)))
      return side == orientation(flat(p), flat(q), flat(b));
  }
  return false;
}

// Whether a plane through the common corner 0 surely separates two triangles, which then share nothing else.
// Any plane would do; the one tried lies between the directions of the triangles.
bool separated(const Corners& p, const Corners& q) {
  const Vec3 to_p[] = {p[1] - p[0], p[2] - p[0]}, to_q[] = {q[1] - q[0], q[2] - q[0]};
  const Vec3 normal = normalized(to_p[0] + to_p[1]) - normalized(to_q[0] + to_q[1]);
  const auto size = [](const Vec3& v) { return std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]); };
  const double error = kProductRounding * size(normal);
  const auto above = [&](const Vec3& v) { return dot(normal, v) > error * size(v); };
  const auto below = [&](const Vec3& v) { return dot(normal, v) < -error * size(v); };
  return above(to_p[0]) && above(to_p[1]) && below(to_q[0]) && below(to_q[1]);
}

}  // namespace

// Triangles that share one corner and another point share the segment between the two; its continuation
// leaves one of the triangles first, through the side opposite to the corner, and there is still in the
// other.
bool faces_intersect(const FaceSoup& mesh, std::uint32_t a, std::uint32_t b) {
  const SharedFirst v(mesh.triangles[a], mesh.triangles[b]);
  const Corners p = corners_of(mesh.positions, v.a), q = corners_of(mesh.positions, v.b);
  if (boxes_apart(p, q)) return false;
  switch (v.shared) {
    case 0:
      return triangles_intersect(p, q) && has_area(p) && has_area(q);
    case 1:
      return !separated(p, q) &&
             (triangles_intersect({p[1], p[2], p[2]}, q) || triangles_intersect({q[1], q[2], q[2]}, p)) &&
             has_area(p) && has_area(q);
    case 2:
      return folded(p[0], p[1], p[2], q[2]);
    default:
      return has_area(p);  // duplicates
  }
}

}  // namespace sdm::sites

namespace sdm {
namespace {

// Calls found(face, face) for each pair of faces that intersect, from any thread, until it returns false.
// Returns whether no pair was left out because more than `most` come so near each other that they must be
// tested.
template <class Found>
bool find_intersections(const sites::SitesData& data, std::uint64_t most, const Progress& progress,
                        const Found& found) {
  const sites::FaceSoup mesh{data.mesh.positions, data.mesh.triangles, data.tree};
  return sites::for_each_near_pair(data, most, progress, [&](std::span<const sites::FacePair> pairs) {
    return std::ranges::all_of(pairs, [&](const sites::FacePair& pair) {
      return !faces_intersect(mesh, pair[0], pair[1]) ||
             found(std::min(pair[0], pair[1]), std::max(pair[0], pair[1]));
    });
  });
}

using FacePairs = std::vector<std::array<std::uint32_t, 2>>;

}  // namespace

std::uint64_t self_intersection_budget(const Sites& sites) {
  constexpr std::uint64_t kLeast = 2'000'000, kOfEachFace = 200;
  return std::max<std::uint64_t>(kLeast, kOfEachFace * sites.mesh().triangles.size());
}

SelfIntersections self_intersections(const Sites& sites, std::uint64_t most,
                                     const SelfIntersectionOptions& options) try {
  SelfIntersections found;
  std::mutex mutex;
  found.all =
      find_intersections(internals(sites), most, options.progress, [&](std::uint32_t a, std::uint32_t b) {
        const std::scoped_lock lock(mutex);
        found.pairs.push_back({a, b});
        return true;
      });
  poll();
  std::ranges::sort(found.pairs);
  return found;
} catch (const std::bad_alloc&) {
  throw out_of_memory("self-intersections");
}

FacePairs self_intersections(const Sites& sites, const SelfIntersectionOptions& options) {
  return self_intersections(sites, sites::kAllPairs, options).pairs;
}

bool is_embedded(const Sites& sites, const SelfIntersectionOptions& options) try {
  std::atomic<bool> embedded{true};
  (void)find_intersections(internals(sites), sites::kAllPairs, options.progress,
                           [&](std::uint32_t, std::uint32_t) {
                             embedded = false;
                             return false;
                           });
  return embedded;
} catch (const std::bad_alloc&) {
  throw out_of_memory("self-intersections");
}

}  // namespace sdm
