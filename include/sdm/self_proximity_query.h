/// Proximity of a mesh to itself: maps, separation and contacts of a surface that folds.
///
/// Threads: an object is used by one thread at a time; different objects may be used concurrently.
#pragma once

#include <sdm/bounds.h>
#include <sdm/execution.h>
#include <sdm/mesh.h>
#include <sdm/options.h>
#include <sdm/proximity_query.h>
#include <sdm/sites.h>
#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// The neighbourhood of a face along the surface, to which no distances are measured.
struct ExclusionRule {
  /// Exclude the face and this many rings of faces around it, connected by shared vertices; ≥ 1.
  std::uint32_t rings = 1;
  /// If set, replaces `rings`: exclude everything closer than this along the surface at rest; > 0, in units
  /// of the mesh.
  std::optional<double> geodesic{};
};

inline constexpr std::array kGeodesicExcludes{ExcludedOption{"rings"}};

template <>
inline constexpr auto kOptions<ExclusionRule> = std::tuple{
    Option{.name = "rings",
           .member = &ExclusionRule::rings,
           .text = "Each face excludes itself and this many rings of neighbours, which share vertices.",
           .range = {1, 1 << 20},
           .value = "K"},
    Option{.name = "geodesic",
           .member = &ExclusionRule::geodesic,
           .text = "Instead: each face excludes what is closer than this along the surface (conservatively).",
           .range = kPositive,
           .unit = "length",
           .value = "L",
           .excludes = kGeodesicExcludes}};

/// Options of an Exclusion.
struct ExclusionOptions {
  ExclusionRule rule{};
  Progress progress{};
};

/// The faces that each face of a mesh excludes: itself and its neighbourhood. The relation is symmetric. It
/// depends on the mesh at rest only, not on later deformation. It is stored for patches: groups of faces that
/// exclude the same faces.
///
/// With rings, every face is a patch of its own. With a geodesic length L, faces form patches around seeds
/// about L/6 apart, which lie in balls of radius L/4; faces too large for that are patches of their own.
/// Patches P and Q exclude each other if a chain of patches, consecutive ones sharing a vertex, leads from P
/// to Q such that every patch of it is less than L from P in a straight line at rest, and likewise a chain
/// from Q to P. Distances are those of single faces, and of the spheres around the bounding boxes of patches
/// of several faces. No point that is not excluded is therefore nearer than L along the surface at rest: the
/// shortest path to it would run through such a chain. The rule is conservative: it excludes whole patches,
/// and so what is up to about 2 L away in a straight line, besides the length of large faces; on fine meshes,
/// 1.6 L. Where the surface at rest folds back within that, it excludes the other side as well.
class SDM_API Exclusion {
 public:
  /// Throws sdm::Error when the mesh is unusable (see validate), for a rule out of range, with rings if more
  /// than 100 pairs of faces for each face, and more than 100 million, share a vertex, and if there is not
  /// enough memory; Cancelled. Memory: with a geodesic length, whatever it is, up to about 200 numbers per
  /// face of a surface with well-shaped faces, but always as many as faces share a vertex; with rings, the
  /// sizes of all neighbourhoods, equal ones of many faces once. Cost: linear in the sizes of all, most of it
  /// on all cores.
  explicit Exclusion(const Mesh& rest, const ExclusionOptions& options = {});

  /// The number of faces of the mesh.
  [[nodiscard]] std::size_t faces() const { return patch_of_.size(); }
  /// The number of patches.
  [[nodiscard]] std::size_t patches() const { return face_offsets_.size() - 1; }
  /// The patch of a face.
  [[nodiscard]] std::uint32_t patch_of(std::uint32_t face) const { return patch_of_[face]; }
  /// The faces of a patch, in increasing order.
  [[nodiscard]] std::span<const std::uint32_t> faces_of(std::uint32_t patch) const {
    return {patch_faces_.data() + face_offsets_[patch], patch_faces_.data() + face_offsets_[patch + 1]};
  }
  /// The patches whose faces the faces of `patch` exclude, itself among them, in increasing order.
  [[nodiscard]] std::span<const std::uint32_t> excluded_by(std::uint32_t patch) const {
    const std::uint32_t row = row_of(patch);
    return {excluded_.data() + offsets_[row], excluded_.data() + offsets_[row + 1]};
  }
  /// Whether two faces exclude each other. Cost: a binary search.
  [[nodiscard]] bool excludes(std::uint32_t face1, std::uint32_t face2) const;

 private:
  void keep_mutual();
  [[nodiscard]] std::uint32_t row_of(std::uint32_t patch) const {
    return rows_.empty() ? patch : rows_[patch];
  }

  std::vector<std::uint32_t> patch_of_;                    ///< of each face
  std::vector<std::uint32_t> patch_faces_, face_offsets_;  ///< the faces of each patch, and where they start
  std::vector<std::uint32_t> rows_;      ///< of each patch: which of the rows below it has; empty: its own
  std::vector<std::uint32_t> excluded_;  ///< patches, by the row
  std::vector<std::size_t> offsets_;     ///< of each row in excluded_, and an end
};

/// A measure (sdm/measure.h): the distance to the closest point of the faces of the same mesh that the
/// sample's face does not exclude. Distances are unsigned, exact up to double rounding, stored in float. A
/// texel with nothing in range, because every face is excluded or farther than max_distance, has the distance
/// +∞, the vector 0, kNone and SiteType::none, and counts as beyond_max_distance; NaN means that no face owns
/// the texel. At a vertex, faces that Sites ignores do not count; NaN means that there are no others. Within
/// a face the distance is 1-Lipschitz; between faces it may jump, as their exclusions differ: the map is of
/// DistanceKind::self, whose samples do not bound the points between them.
///
/// Surface and Sites must be built from the same mesh and positions, the exclusion from the same mesh at
/// rest. Throws sdm::Error if their numbers of faces differ, for a maximum distance out of range, or if there
/// is not enough memory; Cancelled. Cost: one search per texel that skips what is excluded; all cores.
struct SelfOptions {
  const Exclusion& exclusion;  ///< must outlive the options
  double max_distance =
      std::numeric_limits<double>::infinity();  ///< > 0, in units of the mesh: anything farther is ignored
  Progress progress{};
};

/// Options of a SelfProximityQuery.
struct SelfProximityOptions {
  ExclusionRule exclusion{};
  double max_distance =
      std::numeric_limits<double>::infinity();  ///< of separation(); > 0, in units of the mesh
  Progress progress{};                          ///< of the construction
};

template <>
inline constexpr auto kOptions<SelfProximityOptions> = std::tuple{max_distance_option<SelfProximityOptions>(
    "Samples without a surface within this distance have no value.")};

/// Proximity of a deforming mesh to itself, for simulation loops. Results are exact: computed from the
/// triangles, without sampling error.
class SDM_API SelfProximityQuery {
 public:
  /// Throws sdm::Error as Sites and Exclusion do, and for a maximum distance out of range.
  explicit SelfProximityQuery(Mesh rest, const SelfProximityOptions& options = {});
  ~SelfProximityQuery();
  SelfProximityQuery(SelfProximityQuery&&) noexcept;
  SelfProximityQuery& operator=(SelfProximityQuery&&) noexcept;

  /// Moves the vertices; the excluded faces stay the same. Throws sdm::Error, and changes nothing, for a
  /// wrong number of positions or a coordinate that is not finite or beyond 1e37. If there is not enough
  /// memory, it also throws, and changes nothing or leaves the object broken (see sdm/error.h). Cost: linear.
  void refit(std::span<const Vec3> positions);

  /// The smallest distance between two faces that do not exclude each other, 0 if they intersect; exact.
  /// Empty if there are none within the maximum distance. The witness is a point on each of the two faces,
  /// the face of lower index first. Cost: one search per face, bounded by the smallest distance found so far;
  /// all cores.
  [[nodiscard]] std::optional<BoundedLength> separation();

  /// Each face within `margin`, in units of the mesh, of a face that it does not exclude has a contact with
  /// the nearest such face, at their closest points; two faces that are nearest to each other share one
  /// contact. point1 lies on the face of lower index. depth = −|point2 − point1|, as a surface has no inside;
  /// where it is 0, the normal is that of the second face. Contacts belong to the same patch if their boxes,
  /// each around its two faces, intersect. Sorted by patch, the nearest first, and by distance within a
  /// patch. Valid until the next call. Throws sdm::Error for a margin that is negative or not finite. Cost:
  /// one search per face, all cores, and sorting.
  [[nodiscard]] std::span<const Contact> contacts(double margin);

  /// The sites of the mesh in its present shape.
  [[nodiscard]] const Sites& sites() const;
  /// What is excluded, of the mesh at rest.
  [[nodiscard]] const Exclusion& exclusion() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm
