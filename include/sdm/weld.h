/// Joining boundary edges that coincide but for rounding, as of CAD models whose faces were written one by
/// one.
///
/// Threads: the function may be called concurrently, also with the same mesh.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/progress.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

namespace sdm {

/// Options of weld().
struct WeldOptions {
  /// Greater than 0, in units of the mesh: edges are joined if their ends are at most this far apart. Without
  /// a value, edges up to 1e-3 of the diagonal of the mesh's box are.
  std::optional<double> tolerance{};
  Progress progress{};
};

template <>
inline constexpr auto kOptions<WeldOptions> = std::tuple{
    Option{.name = "tolerance",
           .member = &WeldOptions::tolerance,
           .text = "Edges are joined whose ends are at most this far apart; by default up to 0.001 of the "
                   "diagonal of the mesh. No gap wider than a quarter of its edges is closed.",
           .range = kPositive,
           .unit = "length",
           .value = "T"}};

/// What weld() did.
struct WeldReport {
  /// The largest distance between the ends of two edges that were joined; 0 if none were.
  double tolerance = 0;
  double largest_move = 0;  ///< of a vertex; several edges that meet may add up to more than tolerance
  std::size_t joined_vertices = 0;  ///< that have no face any more
  std::size_t boundary_edges = 0;   ///< that are left
  /// Vertices of boundary edges that are left, which lie on another one within the tolerance: one edge there
  /// meets several, and joining vertices closes no such gap.
  std::size_t t_junctions = 0;
};

template <>
inline constexpr std::tuple kFields<WeldReport>{
    Field{"tolerance", &WeldReport::tolerance,
          "The largest distance between the ends of two edges that were joined."},
    Field{"largest_move", &WeldReport::largest_move,
          "The largest move of a vertex: distances to the welded mesh differ from those to the mesh by at "
          "most this."},
    Field{"joined_vertices", &WeldReport::joined_vertices, "The vertices that have no face any more."},
    Field{"boundary_edges", &WeldReport::boundary_edges, "The boundary edges that are left."},
    Field{"t_junctions", &WeldReport::t_junctions,
          "Their vertices that lie in the middle of another one, within the tolerance."}};

/// A mesh whose boundary edges were joined, and how.
struct Welded : WeldReport {
  /// All vertices keep their number; those that were joined to another one have its position and no face.
  Mesh mesh{};
  std::vector<std::uint32_t> vertex{};  ///< of each vertex, the one that its faces have now
};

/// Joins each boundary edge with the one whose ends are closest to its own, within the tolerance and a
/// quarter of the shorter edge's length. Edges that run in opposite directions, as neighbours do that are
/// oriented alike, come first. No two vertices of one face are joined, so no face collapses; nor edges of two
/// faces that turn their backs on each other less than twice the tolerance apart: they are the sides of a
/// thin wall. Distances to the welded mesh differ from those to the mesh by at most largest_move.
///
/// Throws sdm::Error if the mesh is unusable (see validate), for a tolerance that is not positive, or if
/// there is not enough memory; Cancelled. The result does not depend on the number of threads. Cost: that of
/// the topology, and sorting the boundary edges in space.
[[nodiscard]] SDM_API Welded weld(const Mesh& mesh, const WeldOptions& options = {});

}  // namespace sdm
