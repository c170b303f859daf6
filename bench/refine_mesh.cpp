#include "refine_mesh.h"

#include <map>
#include <random>

namespace sdm::bench {
namespace {

class Refinement {
 public:
  Refinement(const Mesh& mesh, std::uint32_t parts) : parts_(parts) {
    result_.positions = mesh.positions;
    for (const Triangle& triangle : mesh.triangles) cut(triangle);
  }

  Mesh take() { return std::move(result_); }

 private:
  std::uint32_t add(const Vec3& p) {
    result_.positions.push_back(p);
    return static_cast<std::uint32_t>(result_.positions.size() - 1);
  }

  /// The vertex at i/parts of the way from a to b; faces on both sides of the edge share it.
  std::uint32_t on_edge(std::uint32_t a, std::uint32_t b, std::uint32_t i) {
    if (i == 0) return a;
    if (i == parts_) return b;
    if (a > b) return on_edge(b, a, parts_ - i);
    const auto [edge, is_new] = edges_.try_emplace({a, b}, result_.positions.size());
    if (is_new)
      for (std::uint32_t k = 1; k < parts_; ++k) add(at(a, b, k));
    return edge->second + i - 1;
  }

  Vec3 at(std::uint32_t a, std::uint32_t b, std::uint32_t i) const {
    const Vec3 &p = result_.positions[a], &q = result_.positions[b];
    return p + (static_cast<double>(i) / parts_) * (q - p);
  }

  void cut(const Triangle& triangle) {
    const auto& [a, b, c] = triangle;
    // Rows parallel to bc; row i has i + 1 vertices, starting on ab.
    std::vector<std::uint32_t> before{a}, row;
    for (std::uint32_t i = 1; i <= parts_; ++i) {
      row = {on_edge(a, b, i)};
      const std::uint32_t end = on_edge(a, c, i);
      for (std::uint32_t j = 1; j < i; ++j) {
        if (i == parts_) {
          row.push_back(on_edge(b, c, j));
        } else {
          const Vec3 &p = result_.positions[row[0]], &q = result_.positions[end];
          row.push_back(add(p + (static_cast<double>(j) / i) * (q - p)));
        }
      }
      row.push_back(end);
      for (std::uint32_t j = 0; j < i; ++j) {
        result_.triangles.push_back({before[j], row[j], row[j + 1]});
        if (j + 1 < i) result_.triangles.push_back({before[j], row[j + 1], before[j + 1]});
      }
      before.swap(row);
    }
  }

  std::uint32_t parts_;
  Mesh result_;
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> edges_;  ///< the first vertex within each edge
};

}  // namespace

Mesh refine_mesh(const Mesh& mesh, std::uint32_t parts, double noise) {
  Mesh result = Refinement(mesh, parts).take();
  double edges = 0;
  for (const auto& [a, b, c] : result.triangles) edges += norm(result.positions[b] - result.positions[a]);
  const double amplitude = noise * edges / static_cast<double>(result.triangles.size());
  std::mt19937 random;
  std::uniform_real_distribution<double> offset(-amplitude, amplitude);
  for (Vec3& p : result.positions)
    for (double& x : p) x += offset(random);
  return result;
}

}  // namespace sdm::bench
