/// Simplification: fewer triangles, with a certificate of how far the result is from the mesh.
///
/// Threads: functions of different objects may be called concurrently; those of one object one after the
/// other.
#pragma once

#include <sdm/bounds.h>
#include <sdm/execution.h>
#include <sdm/mesh.h>
#include <sdm/mesh_attributes.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/sites.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// A mesh with fewer triangles than another one, the input. Vertices of the input with the same position are
/// one, and faces that then have two equal corners are no part of its surface, as for readers of files.
struct Simplified {
  /// Faces wind as those of the input. Its vertices are vertices of the input, in their order, if a number of
  /// triangles is asked for, if they are to be kept (SimplifyOptions::keep_vertices), if the input has
  /// texture coordinates, or if over 5 % of its vertices are not on a manifold; otherwise they are placed
  /// freely, and most of them where the input has over 400,000 triangles. Texture coordinates are those of
  /// the vertices that are left, seams stay seams. At a pole, a vertex at which three faces or more have
  /// texture coordinates of their own, as on spheres by latitude and longitude, a face has those of one of
  /// them. A face that the input does not have has an area in the texture, also rounded to float, and winds
  /// there as the others of its chart.
  Mesh mesh;
  /// The region of each face, by the first face of the input that is in it; empty if the input has no
  /// regions. Borders between regions stay, as seams do.
  std::vector<std::uint32_t> source_faces{};
  /// The symmetric Hausdorff distance of the mesh and the input: no point of either one is farther than
  /// `upper` from the other one, and a point of one is `lower` from it. `value` is `lower`.
  BoundedLength deviation{};
  /// What is said of the same by the collapses, no bound: the largest distance of samples if vertices are
  /// placed freely; otherwise meshoptimizer's own error and, where it simplified in steps, their sum.
  double estimate = 0;
  /// No more triangles could go, although more were to: the borders, seams or non-manifold edges that are
  /// left permit no collapse, faces would have no area in the texture, or none keeps the deviation.
  bool stopped = false;
};

template <>
inline constexpr std::tuple kFields<Simplified>{
    Field{"deviation", &Simplified::deviation,
          "The symmetric Hausdorff distance of the mesh and the input, with certified bounds."},
    Field{"estimate", &Simplified::estimate, "What is said of the same by the collapses: no bound."},
    Field{"stopped", &Simplified::stopped, "No more triangles could go, although more were to."}};

/// Options of Simplifier::to_deviation() and to_triangles().
struct SimplifyOptions {
  /// An earlier result of the same object to go on from, such as the finer one in a chain of levels of
  /// detail: the result has no more triangles. Null: the input.
  const Simplified* from = nullptr;
  /// Positions of the result are rounded to float, as STL and glTF keep them; `deviation` is that of the
  /// rounded mesh.
  bool single_precision = false;
  /// The vertices of the result are vertices of the input. More triangles are left for a deviation.
  bool keep_vertices = false;
  Progress progress{};
};

/// Options of simplify_levels(). Exactly one of the first two is given.
struct LevelsOptions {
  std::optional<double> max_deviation{};     ///< greater than 0, in units of the mesh: of the first level
  std::optional<std::uint64_t> triangles{};  ///< at least 1: of the first level
  std::uint32_t lods = 0;                    ///< levels after it, up to 32
  bool single_precision = false;             ///< as of SimplifyOptions
  bool keep_vertices = false;                ///< as of SimplifyOptions
  std::span<const std::uint32_t> regions{};  ///< as of Simplifier
  Progress progress{};
};

inline constexpr std::array kDeviationExcludes{ExcludedOption{"triangles"}};

template <>
inline constexpr auto kOptions<LevelsOptions> = std::tuple{
    Option{.name = "max_deviation",
           .member = &LevelsOptions::max_deviation,
           .text = "As few triangles as are found for which no point of the result is farther than this from "
                   "the mesh, and none of the mesh farther from the result: certified, not sampled.",
           .range = kPositive,
           .unit = "length",
           .value = "D",
           .excludes = kDeviationExcludes},
    Option{.name = "triangles",
           .member = &LevelsOptions::triangles,
           .text = "At most so many triangles; how far the result deviates is certified.",
           .range = {.least = 1},
           .value = "N"},
    Option{.name = "lods",
           .member = &LevelsOptions::lods,
           .text = "So many further levels of detail, each with twice the deviation or half of the triangles "
                   "of the one before, from which it is made.",
           .range = {0, 32},
           .value = "N"},
    Option{.name = "keep_vertices",
           .member = &LevelsOptions::keep_vertices,
           .text =
               "The vertices of the result are vertices of the mesh. They are so in any case with a number "
               "of triangles, and where the mesh has texture coordinates; without this, a deviation places "
               "them freely, which leaves fewer triangles."}};

/// What the calls so far have cost. Phases that run beside each other count twice.
struct SimplifyReport {
  double sites_ms = 0;         ///< the search structure of the input
  double collapse_ms = 0;      ///< collapses
  double deviation_ms = 0;     ///< certificates
  std::size_t candidates = 0;  ///< meshes that were measured
};

/// Simplifies a mesh by collapsing edges, and proves how far the results are from it: to a number of
/// triangles by meshoptimizer's quadric simplifier, to a deviation by collapses that are measured one by one.
/// What all results need of the mesh is made once.
class SDM_API Simplifier {
 public:
  /// Vertices at the same position are welded, faces that repeat a corner left out. `regions`: a number for
  /// each face, such as that of its material (see face_regions()), or none; where faces of several regions
  /// meet, vertices of all results are vertices of the input, and collapses of these borders are along them.
  /// Throws sdm::Error if the mesh is unusable (see validate), for another number of regions, or if there is
  /// not enough memory. Cost: linear.
  explicit Simplifier(const Mesh& mesh, std::span<const std::uint32_t> regions = {});
  ~Simplifier();
  Simplifier(Simplifier&&) noexcept;
  Simplifier& operator=(Simplifier&&) noexcept;

  /// Returns a mesh whose deviation is certified to be at most `max_deviation`, greater than 0, in units of
  /// the mesh. Edges are collapsed in steps that do not depend on the limit, and the result is the last mesh
  /// on the way that keeps it: about as few triangles are left as the simplifier reaches, though not provably
  /// the fewest, and never more than with a smaller limit. Where no step keeps the limit, the result is the
  /// input, or `from`, and `stopped`.
  ///
  /// Throws sdm::Error for a limit that is not a positive number, one that rounding to float or `from`
  /// exceeds, or if there is not enough memory; Cancelled. Cost: the sites of the input, once; the closest
  /// points of its vertices for each of some 10 to 20 candidates, and of points of one or a few results,
  /// dense enough to tell whether they keep the limit.
  [[nodiscard]] Simplified to_deviation(double max_deviation, const SimplifyOptions& options = {});

  /// Returns a mesh of at most `triangles`, at least 1, with its certified deviation, whose bounds are about
  /// 1 % apart: by effort, which is limited, and at most to 1e-6 of the diagonal of the mesh. More are left
  /// where `stopped` says so, and where fewer would have no area.
  ///
  /// Errors as above. Cost: the sites of the input, once, and one candidate.
  [[nodiscard]] Simplified to_triangles(std::size_t triangles, const SimplifyOptions& options = {});

  /// What the calls so far have taken.
  [[nodiscard]] const SimplifyReport& report() const;

 private:
  class State;
  std::unique_ptr<State> state_;
};

/// Levels of detail, the finest first, and what they cost.
struct SimplifiedLevels {
  std::vector<Simplified> levels{};
  SimplifyReport report{};
};

/// Returns 1 + options.lods meshes with fewer triangles, each made from the one before and certified against
/// the given mesh. The k-th has 2^k times the deviation, or at most triangles / 2^k of them, but one. Throws
/// sdm::Error for options out of range, and as Simplifier does; Cancelled. Cost: that of its calls.
[[nodiscard]] SDM_API SimplifiedLevels simplify_levels(const Mesh& mesh, const LevelsOptions& options);

/// Returns regions of faces for a Simplifier: those with the same material and the same names are one, whose
/// number is that of its first face. Throws sdm::Error for arrays of other numbers of faces. Cost: linear in
/// faces and kinds of names.
[[nodiscard]] SDM_API std::vector<std::uint32_t> face_regions(std::size_t faces,
                                                              std::span<const std::uint32_t> face_materials,
                                                              std::span<const FaceNames> names);

/// Returns the attributes of a mesh, that of the sites, at the corners of the faces of another one near it,
/// such as a simplified one. A corner has the value at its closest point on the face that is closest to a
/// point just inside its own face: where values jump, as normals do at hard edges, each face has those of its
/// side. Of corners off the surface, only faces count that face as its face does. Normals have length 1.
/// Corners of a vertex whose values are almost equal share a row. Throws sdm::Error if an attribute does not
/// belong to the mesh, or if there is not enough memory; Cancelled. Cost: a search for each corner, all
/// cores.
[[nodiscard]] SDM_API std::vector<MeshAttribute> carried_attributes(const Sites& from,
                                                                    std::span<const MeshAttribute> attributes,
                                                                    const Mesh& to,
                                                                    const Progress& progress = {});

}  // namespace sdm
