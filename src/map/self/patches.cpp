#include "map/self/patches.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "core/parallel.h"
#include "geometry/vec.h"

namespace sdm::self {
namespace {

// How far a patch may reach beyond the ball of its centroids: it bounds the spheres around patches.
constexpr double kCornerReach = 1.5;

std::vector<Vec3> centroids(const Mesh& mesh) {
  std::vector<Vec3> result(mesh.triangles.size());
  parallel_for(result.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto& [a, b, c] = mesh.triangles[f];
      // Thirds first: coordinates may be close to the largest of the type.
      constexpr double kThird = 1.0 / 3;
      result[f] = kThird * mesh.positions[a] + kThird * mesh.positions[b] + kThird * mesh.positions[c];
    }
  });
  return result;
}

Patches with_faces(std::vector<std::uint32_t> patch_of, std::size_t count) {
  Patches patches{make_rows<std::uint32_t>(count,
                                           [&](const auto& put) {
                                             for (std::uint32_t f = 0; f < patch_of.size(); ++f)
                                               put(patch_of[f], f);
                                           }),
                  {}};
  patches.of = std::move(patch_of);
  return patches;
}

}  // namespace

CompressedRows<std::uint32_t> faces_of_vertices(const Mesh& mesh) {
  return make_rows<std::uint32_t>(mesh.positions.size(), [&](const auto& put) {
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
      for (const std::uint32_t v : mesh.triangles[f]) put(v, f);
  });
}

Patches single_faces(std::size_t faces) {
  std::vector<std::uint32_t> patch_of(faces);
  std::iota(patch_of.begin(), patch_of.end(), 0u);
  return with_faces(std::move(patch_of), faces);
}

Patches group_faces(const Mesh& mesh, const CompressedRows<std::uint32_t>& faces_of_vertex, double radius) {
  const std::size_t count = mesh.triangles.size();
  const std::vector<Vec3> centroid = centroids(mesh);
  std::vector<std::uint32_t> patch_of(count, kNone), seen_by(count, kNone),
      met_by(mesh.positions.size(), kNone);
  std::vector<double> nearest(count, std::numeric_limits<double>::infinity());  // squared
  std::vector<std::uint32_t> flood;
  std::uint32_t patches = 0;
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    if (patch_of[seed] != kNone) continue;
    const std::uint32_t patch = patches++;
    patch_of[seed] = patch, nearest[seed] = 0;
    const auto within = [&](double reach, const Vec3& p) {
      return squared_norm(p - centroid[seed]) <= reach * reach;
    };
    const auto fits = [&](std::uint32_t face) {
      return within(radius, centroid[face]) &&
             std::ranges::all_of(mesh.triangles[face], [&](std::uint32_t v) {
               return within(kCornerReach * radius, mesh.positions[v]);
             });
    };
    if (!fits(seed)) continue;
    const auto enter = [&](std::uint32_t face) {
      if (seen_by[face] == patch) return;
      seen_by[face] = patch;
      if (!fits(face)) return;
      const double squared = squared_norm(centroid[face] - centroid[seed]);
      flood.push_back(face);
      if (squared < nearest[face]) nearest[face] = squared, patch_of[face] = patch;
    };
    flood.clear();
    enter(seed);
    for (std::size_t i = 0; i < flood.size(); ++i)
      for (const std::uint32_t v : mesh.triangles[flood[i]]) {
        if (met_by[v] == patch) continue;
        met_by[v] = patch;
        for (const std::uint32_t face : faces_of_vertex.of(v)) enter(face);
      }
  }
  return with_faces(std::move(patch_of), patches);
}

}  // namespace sdm::self
