#include "io/page/report/fewer_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "core/cancellation.h"
#include "geometry/vec.h"
#include "map/statistics/texel_areas.h"

namespace sdm::io {
namespace {

// The vertex that stands for each vertex.
std::vector<std::uint32_t> clustered(const Mesh& mesh, std::span<const float> distances, double cell) {
  const Vec3 lo = bounds(mesh).lower;
  constexpr double kMostCells = 1 << 20;  // along a side, so that three numbers fit one key
  const auto key = [&](const Vec3& p) {
    std::uint64_t result = 0;
    for (int k = 0; k < 3; ++k)
      result = result << 21 | static_cast<std::uint64_t>(std::clamp((p[k] - lo[k]) / cell, 0.0, kMostCells));
    return result;
  };
  const auto size = [&](std::uint32_t v) {
    return std::isfinite(distances[v]) ? std::abs(distances[v]) : -1;
  };
  std::unordered_map<std::uint64_t, std::uint32_t> cell_of;
  std::vector<std::uint32_t> largest;                               // of each cell
  std::vector<std::uint32_t> result(mesh.positions.size(), kNone);  // first the cells
  Poll due(4096);
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) {
      due();
      if (result[v] != kNone) continue;
      const auto [place, is_new] =
          cell_of.try_emplace(key(mesh.positions[v]), static_cast<std::uint32_t>(largest.size()));
      if (is_new)
        largest.push_back(v);
      else if (size(v) > size(largest[place->second]))
        largest[place->second] = v;
      result[v] = place->second;
    }
  for (std::uint32_t& cell_or_vertex : result)
    if (cell_or_vertex != kNone) cell_or_vertex = largest[cell_or_vertex];
  return result;
}

std::vector<Triangle> remaining(const Mesh& mesh, std::span<const std::uint32_t> cluster) {
  std::vector<Triangle> result;
  for (const auto& [a, b, c] : mesh.triangles) {
    // The smallest corner first, in the same direction, so that equal triangles are equal.
    std::array<std::uint32_t, 3> t{cluster[a], cluster[b], cluster[c]};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    std::ranges::rotate(t, std::ranges::min_element(t));
    result.push_back(t);
  }
  std::ranges::sort(result);
  const auto repeated = std::ranges::unique(result);
  result.erase(repeated.begin(), repeated.end());
  return result;
}

}  // namespace

FewerVertices fewer_vertices(const Mesh& mesh, std::span<const float> distances, std::size_t most) {
  // About two triangles for each cell that a surface crosses.
  double cell = std::sqrt(2 * map::surface_area(mesh) / static_cast<double>(std::max<std::size_t>(most, 1)));
  if (!(cell > 0)) cell = diagonal(bounds(mesh));
  std::vector<Triangle> triangles;
  do {
    poll();
    triangles = remaining(mesh, clustered(mesh, distances, cell));
    cell *= 1.25;
  } while (triangles.size() > most);

  FewerVertices result;
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);
  for (Triangle& triangle : triangles)
    for (std::uint32_t& vertex : triangle) {
      if (number[vertex] == kNone) {
        number[vertex] = static_cast<std::uint32_t>(result.mesh.positions.size());
        result.mesh.positions.push_back(mesh.positions[vertex]);
        result.distances.push_back(distances[vertex]);
        result.vertex.push_back(vertex);
      }
      vertex = number[vertex];
    }
  result.mesh.triangles = std::move(triangles);
  return result;
}

}  // namespace sdm::io
