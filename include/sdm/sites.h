/// The object that distances are measured to (O2): the open faces, open edges and vertices of a mesh; what is
/// inside of it, where it intersects itself, and the volume of the solid that it bounds.
///
/// Threads: const functions of Sites may be called concurrently, as may all queries of them; nothing else may
/// run beside refit() and edit().
#pragma once

#include <sdm/bounds.h>
#include <sdm/execution.h>
#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>
#include <sdm/names.h>
#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {
namespace sites {
class SitesData;
}

/// The kinds of sites; none: no site.
enum class SiteType : std::uint8_t { vertex = 0, edge = 1, face = 2, none = 0xFF };

/// The closest point of O2 to a query, and the site it lies on.
struct ClosestPoint {
  Vec3 point{};
  double distance = kInfinity;     ///< ≥ 0, = |point − query|
  std::uint32_t site = kNone;      ///< index among the sites of its type
  SiteType type = SiteType::none;  ///< none: no site within the maximum distance
  std::uint32_t face = kNone;      ///< a face that the site belongs to
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

/// How inside and outside of O2 are distinguished. Negative distances are inside.
enum class SignMethod {
  automatic,  ///< exact where O2 is closed and orientable, else none
  none,       ///< unsigned distances
  /// Inside of a closed, orientable O2 are the points with a winding number other than 0, with all shells
  /// oriented outwards, whether O2 intersects itself or not. A shell is a cavity if it lies inside an odd
  /// number of other shells that it neither touches nor intersects, otherwise a solid. Exact at points
  /// farther from O2 than 1e-6 of the diagonal of the scene.
  exact,
  /// The same as exact for closed, orientable O2. Inside of any other O2 are the points with a generalised
  /// winding number above 1/2 (Jacobson et al. 2013), decided to rounding; an estimate of insideness.
  winding,
  /// The same as exact for closed, orientable O2. Behind any other orientable O2 (negative) are the points on
  /// the side to which its normals do not point: with c the closest point and n the pseudonormal of the site
  /// that c lies on, q is behind where (q − c)·n < 0. Normals are those of most faces of each component.
  /// Points whose closest site is a boundary edge of O2, or a vertex of one, have no side and keep distances
  /// ≥ 0; boundary_mask() marks them. An estimate: the sign changes where no distance is 0, beyond the
  /// boundary.
  side,
};

template <>
inline constexpr std::array kWords<SignMethod>{"automatic", "none", "exact", "winding", "side"};

/// Whether a method estimates signs: between samples a distance may have the other sign.
[[nodiscard]] constexpr bool is_estimate(SignMethod method) {
  return method == SignMethod::winding || method == SignMethod::side;
}

/// The method that was used, and the reason in words, for reports.
struct SignUsed {
  SignMethod method = SignMethod::none;
  std::string reason;
};

template <>
inline constexpr std::tuple kFields<SignUsed>{Field{"method", &SignUsed::method, "The method that was used."},
                                              Field{"reason", &SignUsed::reason, "Why, in words."}};

/// Returns the sign method that compute_map uses for `asked`, with the reason. Throws sdm::Error if O2 does
/// not allow it.
[[nodiscard]] SDM_API SignUsed choose_sign(const Sites& sites, SignMethod asked);

/// Returns, for each query, whether it lies inside O2 (1) or not (0) according to `method`; all are 0 if no
/// method is used. `closest` are the closest points of the queries, from closest_points with the same sites;
/// exact returns 0 where there is no site, and points on the boundary of the solid are not inside. What the
/// method needs is kept with the sites until they change: the first call makes it, in O(n log n). Throws
/// sdm::Error for a method that O2 does not allow, for a query with a coordinate that is NaN or beyond 1e37,
/// if the numbers of queries and closest points differ, or if there is not enough memory.
[[nodiscard]] SDM_API std::vector<std::uint8_t> inside_flags(const Sites& sites,
                                                             std::span<const Vec3> queries,
                                                             std::span<const ClosestPoint> closest,
                                                             SignMethod method);

/// Options of self_intersections() and is_embedded().
struct SelfIntersectionOptions {
  Progress progress{};
};

/// Returns the pairs of faces that have a point in common beyond the corners and edges that they share, each
/// once, the smaller face first, in lexicographic order. Empty for an embedded mesh. Touching counts; faces
/// without area and duplicate faces do not. Exact, for coordinates as they are. Throws Cancelled, and
/// sdm::Error if there is not enough memory. Cost: O(n log n) for n faces, plus linear in the
/// pairs of faces whose boxes overlap, of faces at one vertex or edge their directions from it; all cores.
[[nodiscard]] SDM_API std::vector<std::array<std::uint32_t, 2>> self_intersections(
    const Sites& sites, const SelfIntersectionOptions& options = {});

/// What was found within a budget.
struct SelfIntersections {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  bool all = true;  ///< otherwise, there may be others
};

/// The same, of `most` pairs of faces that come so near each other that they must be tested: in the plane, or
/// where needles cross, all pairs may. Which ones does not depend on the number of threads.
[[nodiscard]] SDM_API SelfIntersections self_intersections(const Sites& sites, std::uint64_t most,
                                                           const SelfIntersectionOptions& options = {});

/// A number of pairs that takes a second or, of large meshes, seconds, and far more than usual meshes have:
/// 200 for each face, at least 2 million.
[[nodiscard]] SDM_API std::uint64_t self_intersection_budget(const Sites& sites);

/// Whether there are none. Stops at the first one.
[[nodiscard]] SDM_API bool is_embedded(const Sites& sites, const SelfIntersectionOptions& options = {});

/// Options of solid_volume().
struct SolidVolumeOptions {
  std::optional<bool> embedded{};  ///< is_embedded(), where it is known
};

/// Returns the volume of the points that a closed, orientable mesh winds around, with its shells oriented
/// outwards: parts that several shells cover count once. `exact`, to 1e-8 of the volume of the bounding box,
/// unless faces nearly coincide or many of them meet in a point without being connected there; `bounded`
/// then, with the middle of the bounds as its value. Throws sdm::Error for a mesh that is not closed and
/// orientable, or if there is not enough memory. Cost: that of is_embedded(); if the mesh is not embedded,
/// also that of dividing the faces that intersect others.
[[nodiscard]] SDM_API BoundedNumber solid_volume(const Sites& sites, const SolidVolumeOptions& options = {});

}  // namespace sdm
