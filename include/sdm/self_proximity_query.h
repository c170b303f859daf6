/// Proximity of a mesh to itself: maps, separation and contacts of a surface that may fold.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/proximity_query.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace sdm {

/// The neighbourhood of a face along the surface, to which no distances are measured.
struct ExclusionRule {
  /// The face, all faces that share a vertex with it, and so on, this many times; ≥ 1.
  std::uint32_t rings = 1;
  /// Instead: faces closer than this along the surface at rest; > 0, in units of the mesh.
  std::optional<double> geodesic{};
};

/// The faces that each face of a mesh excludes: itself, and its neighbourhood. Two faces exclude each other,
/// or neither does. Depends on the mesh at rest only, however it is deformed later.
///
/// With a geodesic length L, face g is excluded for f if faces that share vertices, one with the next, lead
/// from f to g, all of them less than L from f in a straight line at rest; and as well from g to f. So no
/// point that remains is nearer than L along the surface at rest: the way to it would be such a chain. It is
/// conservative: it excludes more where the surface folds back within L at rest.
class SDM_API Exclusion {
 public:
  /// Throws sdm::Error when the mesh is unusable (see validate), for a rule out of range, and if there is
  /// not enough memory for all neighbourhoods; Cancelled. Cost: the sum of their sizes, with L that many
  /// distances of triangles; all cores.
  explicit Exclusion(const Mesh& rest, const ExclusionRule& rule = {}, const Progress& progress = {});

  [[nodiscard]] std::size_t faces() const { return offsets_.size() - 1; }
  /// In increasing order.
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t face) const {
    return {excluded_.data() + offsets_[face], excluded_.data() + offsets_[face + 1]};
  }

 private:
  void keep_mutual();

  std::vector<std::size_t> offsets_;  ///< of each face in excluded_, and an end
  std::vector<std::uint32_t> excluded_;
};

struct SelfMapOptions {
  double max_distance =
      std::numeric_limits<double>::infinity();  ///< > 0, in units of the mesh: what is farther does not count
  Progress progress{};
};

/// At every texel the nearest point of the faces that the texel's face does not exclude: unsigned, exact to
/// double rounding, stored in float. A texel with nothing in range, because all is excluded or farther than
/// max_distance, has the distance +∞, the vector 0, kNone and SiteType::none, and counts as
/// beyond_max_distance; NaN means that no face owns the texel. Within a face the distance is 1-Lipschitz;
/// from face to face it may jump, as the exclusion does.
///
/// `surface` and `sites` are built from the same mesh and positions, `exclusion` from the same mesh at rest;
/// throws sdm::Error if their numbers of faces differ, for a maximum distance out of range, and for want of
/// memory; Cancelled. Cost: one search per texel that skips excluded faces; all cores.
[[nodiscard]] SDM_API DistanceMap compute_self_map(const Surface& surface, const Sites& sites,
                                                   const Exclusion& exclusion,
                                                   const SelfMapOptions& options = {});

/// The same at the vertices: of each, the least over its faces; +∞ with nothing in range, NaN at a vertex
/// without faces. Faces that Sites ignores do not count.
[[nodiscard]] SDM_API std::vector<float> self_distances_at_vertices(const Sites& sites,
                                                                    const Exclusion& exclusion,
                                                                    const SelfMapOptions& options = {});

struct SelfProximityOptions {
  ExclusionRule exclusion{};
  double max_distance =
      std::numeric_limits<double>::infinity();  ///< > 0, of separations, in units of the mesh
  Progress progress{};                          ///< of the construction
};

/// The proximity of a deforming mesh to itself: for simulation loops. Results are computed from the
/// triangles, not from samples, so they need no bounds.
class SDM_API SelfProximityQuery {
 public:
  /// Throws sdm::Error as Sites and Exclusion do, and for a maximum distance out of range.
  explicit SelfProximityQuery(Mesh rest, const SelfProximityOptions& options = {});
  ~SelfProximityQuery();
  SelfProximityQuery(SelfProximityQuery&&) noexcept;
  SelfProximityQuery& operator=(SelfProximityQuery&&) noexcept;

  /// Moves the vertices; the excluded faces stay the same. Throws sdm::Error, and changes nothing, for a
  /// wrong count or a coordinate that is not finite or beyond 1e37. Cost: linear.
  void refit(std::span<const Vec3> positions);

  /// The smallest distance between two faces that do not exclude each other, 0 if they intersect; exact.
  /// Empty if there are none within the maximum distance. The witness is a point of either face, that of the
  /// lower index first. Cost: a search a face, with the least distance found so far as its bound; all cores.
  [[nodiscard]] std::optional<BoundedLength> separation();

  /// Each face that comes as near as `margin`, in units of the mesh, to a face it does not exclude has a
  /// contact with the nearest of those, at their closest points; one for two faces that are each other's.
  /// point1 lies on the face of the lower index; depth = −|point2 − point1|, for a surface has no inside;
  /// where that is 0, the normal is the second face's. Contacts whose boxes, each around its two faces, meet
  /// are of one patch: the nearest patch comes first, and in each the nearest contact. Valid until the next
  /// call. Throws sdm::Error for a margin that is negative or not finite. Cost: a search a face, all cores,
  /// and sorting.
  [[nodiscard]] std::span<const Contact> contacts(double margin);

  [[nodiscard]] const Sites& sites() const;
  [[nodiscard]] const Exclusion& exclusion() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm
