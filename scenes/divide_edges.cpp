#include "scenes/divide_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace sdm::scenes {
namespace {

/// Divides every edge that is longer than `longest`, once. Returns whether there was any.
bool divide_once(Mesh& mesh, double longest) {
  std::unordered_map<std::uint64_t, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [lo, hi] = std::minmax(a, b);
    if (norm(mesh.positions[hi] - mesh.positions[lo]) <= longest) return kNone;
    const auto [found, is_new] = middles.try_emplace(std::uint64_t{lo} << 32 | hi, mesh.positions.size());
    if (is_new) mesh.positions.push_back(0.5 * (mesh.positions[lo] + mesh.positions[hi]));
    return found->second;
  };
  std::vector<Triangle> triangles;
  triangles.reserve(2 * mesh.triangles.size());
  for (Triangle t : mesh.triangles) {
    std::array<std::uint32_t, 3> m{};  // of the edges from corner k to the next one
    for (int k = 0; k < 3; ++k) m[k] = middle(t[k], t[(k + 1) % 3]);
    const auto divided = std::ranges::count_if(m, [](std::uint32_t v) { return v != kNone; });
    if (divided == 0) {
      triangles.push_back(t);
      continue;
    }
    if (divided == 3) {
      triangles.insert(triangles.end(),
                       {{t[0], m[0], m[2]}, {t[1], m[1], m[0]}, {t[2], m[2], m[1]}, {m[0], m[1], m[2]}});
      continue;
    }
    // Turned so that the first edge is divided and, of two, the second one as well.
    int first = 0;
    while (m[first] == kNone || (divided == 2 && m[(first + 1) % 3] == kNone)) ++first;
    std::rotate(t.begin(), t.begin() + first, t.end());
    std::rotate(m.begin(), m.begin() + first, m.end());
    if (divided == 1) {
      triangles.insert(triangles.end(), {{t[0], m[0], t[2]}, {m[0], t[1], t[2]}});
      continue;
    }
    triangles.push_back({m[0], t[1], m[1]});
    // The rest is a quadrangle, cut along its shorter diagonal.
    const auto length = [&](std::uint32_t a, std::uint32_t b) {
      return squared_norm(mesh.positions[a] - mesh.positions[b]);
    };
    if (length(t[0], m[1]) < length(m[0], t[2]))
      triangles.insert(triangles.end(), {{t[0], m[0], m[1]}, {t[0], m[1], t[2]}});
    else
      triangles.insert(triangles.end(), {{t[0], m[0], t[2]}, {m[0], m[1], t[2]}});
  }
  mesh.triangles = std::move(triangles);
  return !middles.empty();
}

Mesh divided(Mesh mesh, double longest, std::size_t most) {
  while (mesh.triangles.size() < most && divide_once(mesh, longest)) {
  }
  return mesh;
}

}  // namespace

Mesh divide_edges(const Mesh& mesh, std::size_t triangles) {
  Mesh start{mesh.positions, mesh.triangles, {}};
  double area = 0;
  for (const Triangle& t : mesh.triangles)
    area += 0.5 * norm(cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                             mesh.positions[t[2]] - mesh.positions[t[0]]));
  // The longest edge between which and half of it the others are, by bisection of its logarithm: equilateral
  // triangles would have sides of about 1.5 √(area / triangles).
  double lo = 0.3 * std::sqrt(area / static_cast<double>(triangles)), hi = 40 * lo;
  for (int step = 0; step < 12; ++step) {
    const double longest = std::sqrt(lo * hi);
    (divided(start, longest, 2 * triangles).triangles.size() > triangles ? lo : hi) = longest;
  }
  return divided(start, hi, 2 * triangles);
}

}  // namespace sdm::scenes
