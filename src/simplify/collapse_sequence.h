// Collapses of edges in the order of the deviation that they need.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <queue>
#include <span>
#include <vector>

#include "simplify/carried_points.h"
#include "simplify/collapsing_mesh.h"
#include "simplify/quadric.h"
#include "sites/sites_data.h"

namespace sdm::simplify {

/// Deviations on a ladder: rung k is a fixed length times kFactor^k.
class Ladder {
 public:
  static constexpr double kFactor = 1.09;
  static constexpr int kLowest = -256;  // 1e-10 of the size and less

  explicit Ladder(double size) : size_(size) {}
  [[nodiscard]] double length(int rung) const;
  /// The first rung that is not less.
  [[nodiscard]] int above(double length) const;
  /// The last rung that is not greater.
  [[nodiscard]] int below(double length) const;

 private:
  double size_;
};

/// The edge from u to v becomes u, at another place. The last collapses that made u and v; kNone: none did.
struct CollapseOfEdge {
  std::uint32_t u, v;
  Vec3 to;
  std::uint32_t before_u, before_v;
};

/// The collapses of a mesh that need no more than ever larger deviations from it. They do not depend on how
/// far one goes: all simplifications of a mesh are beginnings of one sequence.
///
/// A vertex that replaces an edge is where the planes of the faces that it stands for are nearest, and the
/// first edge is that with the least error of these (see Quadric), of those whose deviation is within the
/// rung: of points of the input from the faces around the edge, and of points of these faces from the input.
/// As these are samples, a deviation may be larger: a certificate is needed.
class CollapseSequence {
 public:
  /// Begins with the input, the mesh of the sites, or with another mesh that it was simplified to. The sites
  /// must outlive this object.
  CollapseSequence(const Mesh& start, const Sites& input, double size);

  /// Whether the surface is a manifold, up to few vertices.
  [[nodiscard]] bool is_possible() const;
  /// Goes on until no other collapse keeps the rung.
  void advance(int rung);
  /// The collapses that keep a rung, which was reached.
  [[nodiscard]] std::span<const CollapseOfEdge> up_to(int rung) const;
  /// The faces that these leave.
  [[nodiscard]] std::size_t faces_after(int rung) const;

 private:
  struct Edge {
    double cost;
    int rung;
    std::uint32_t u, v, moves_u, moves_v;
  };
  struct Costlier {
    bool operator()(const Edge& a, const Edge& b) const;
  };
  struct Later {
    bool operator()(const Edge& a, const Edge& b) const;
  };
  struct Target {
    Vec3 to;
    double cost;
  };

  void add_planes();
  void push(std::uint32_t u, std::uint32_t v);
  void push(const Edge& edge);
  [[nodiscard]] Target target(std::uint32_t u, std::uint32_t v) const;
  void try_collapse(Edge edge);
  /// The deviation of the faces that replace those around an edge, if the rung allows it; otherwise, a part
  /// of it that it does not allow. Not larger than needed to exceed `enough`.
  [[nodiscard]] double deviation(const Edge& edge, const Vec3& to, double enough);
  [[nodiscard]] double deviation_of_faces(const Edge& edge, const Vec3& to, double enough);
  void commit(const Edge& edge, const Vec3& to);

  CollapsingMesh mesh_;
  CarriedPoints points_;
  const sites::SitesData& sites_;  // of the input
  Ladder ladder_;
  Vec3 middle_;        // quadrics are relative to it
  std::size_t faces_;  // at first
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> moves_, last_;  // of vertices
  std::priority_queue<Edge, std::vector<Edge>, Costlier> ready_;
  std::priority_queue<Edge, std::vector<Edge>, Later> later_;
  std::vector<MovedFace> moved_;
  std::vector<CarriedPoints::Sample> samples_;

  struct End {
    int rung;
    std::size_t collapses, faces;
  };
  int rung_ = Ladder::kLowest;
  std::vector<CollapseOfEdge> collapses_;
  std::vector<End> ends_;
};

/// The mesh after some collapses, and the last one that made each of its vertices. Those that are held back,
/// if any, and those that need them are left out, and others where the mesh then does not permit them.
struct CollapsedMesh {
  Mesh mesh;
  std::vector<std::uint32_t> last;
  std::vector<std::uint32_t> faces;  ///< of each face, its number before
};
[[nodiscard]] CollapsedMesh after_collapses(const Mesh& start, std::span<const CollapseOfEdge> collapses,
                                            const std::vector<bool>& held);

}  // namespace sdm::simplify
