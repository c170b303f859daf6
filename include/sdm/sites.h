/// The object that distances are measured to (O2): the open faces, open edges and vertices of a mesh.
///
/// Threads: const functions of an object may be called concurrently, as may all queries of it; nothing else
/// may run beside refit() and edit().
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>

namespace sdm {
namespace sites {
class SitesData;
}

/// The kinds of sites; none: no site.
enum class SiteType : std::uint8_t { vertex = 0, edge = 1, face = 2, none = 0xFF };

/// The closest point of O2 to a query, and the site it lies on.
struct ClosestPoint {
  Vec3 point{};
  double distance = std::numeric_limits<double>::infinity();  ///< ≥ 0, = |point − query|
  std::uint32_t site = kNone;                                 ///< index among the sites of its type
  SiteType type = SiteType::none;                             ///< none: no site within the maximum distance
  std::uint32_t face = kNone;                                 ///< a face that the site belongs to
};

/// O2: the sites of a mesh with their regions of influence, pseudonormals, and an AABB tree.
///
/// Vertices and faces are numbered as in the mesh, edges as in edges(). Duplicate faces, and degenerate faces
/// with repeated corners, are ignored; other faces without area contribute their edges and vertices.
class SDM_API Sites {
 public:
  /// Throws sdm::Error when the mesh is unusable (see validate) or there is not enough memory. Cost:
  /// O(n log n), all cores.
  explicit Sites(Mesh mesh);
  ~Sites();
  Sites(Sites&&) noexcept;
  Sites& operator=(Sites&&) noexcept;

  /// Moves the vertices and keeps the triangles. Cost: linear; for a closed mesh of several components also a
  /// ray for each of them, and tests of the pairs of faces of different components whose boxes overlap.
  /// Throws sdm::Error, and changes nothing, when the count differs or a coordinate is not finite or beyond
  /// 1e37. If there is not enough memory, it also throws, and changes nothing or leaves the object broken
  /// (see sdm/error.h).
  void refit(std::span<const Vec3> positions);

  /// Changes the mesh. Afterwards every query has the result of Sites(mesh()), edge numbers included: those
  /// follow from the vertices (see edges()), so they shift when edges appear or disappear. Of sites equally
  /// close in the precision of the engine, another one may be found. Throws sdm::Error, and changes nothing,
  /// as apply() does, and if there is not enough memory.
  ///
  /// Cost: linear in the mesh even for a small edit, all cores: three to four times a refit, or two thirds to
  /// nine tenths of building anew. Edges and the tree are repaired where the mesh changed; the orientation,
  /// and the regions of all sites, are computed again. Edges are built anew for meshes with duplicate faces,
  /// and so is the tree when a quarter of its faces have been added.
  void edit(const MeshEdit& edit);

  /// The mesh in its present shape.
  [[nodiscard]] const Mesh& mesh() const;
  /// The two vertices of each edge, the smaller index first, in lexicographic order.
  [[nodiscard]] std::span<const std::array<std::uint32_t, 2>> edges() const;
  /// Whether every edge has exactly two faces.
  [[nodiscard]] bool closed() const;
  /// Whether the faces can be oriented consistently; Sites orients its own copy.
  [[nodiscard]] bool orientable() const;

 private:
  explicit Sites(std::unique_ptr<sites::SitesData> data);
  friend const sites::SitesData& internals(const Sites&);
  friend Sites with_data(std::unique_ptr<sites::SitesData>);

  std::unique_ptr<sites::SitesData> data_;
};

}  // namespace sdm
