/// Islands: small connected components of a mesh, such as the floating specks of a scan.
///
/// Threads: the functions may be called concurrently, also with the same mesh.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>
#include <sdm/names.h>

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

namespace sdm {

/// Which components are islands: those below one of these limits. A limit of 0 has no effect.
struct IslandLimits {
  std::size_t faces = 0;
  double area = 0;           ///< in squared units of the mesh; ≥ 0
  double area_fraction = 0;  ///< of the area of the mesh; in [0, 1]
};

/// What was removed.
struct IslandReport {
  std::size_t islands = 0, faces = 0;
  double area = 0;
  double area_fraction = 0;  ///< of the area of the mesh, in [0, 1]
};

template <>
inline constexpr std::tuple kFields<IslandReport>{
    Field{"islands", &IslandReport::islands, "The number of components."},
    Field{"faces", &IslandReport::faces, "The number of their faces."},
    Field{"area", &IslandReport::area, "Their area."},
    Field{"area_fraction", &IslandReport::area_fraction, "That as a fraction of the area of the mesh."}};

/// A mesh without its islands. Its vertices have the numbers that they had; some may have no face.
struct WithoutIslands : IslandReport {
  Mesh mesh;
  std::vector<std::uint32_t> face;  ///< the number that each of its faces had; removed faces are not left
};

/// Returns the mesh without the components (see face_components()) that are below a limit. Throws sdm::Error
/// for a mesh that is unusable (see validate) or without islands would be, and for limits out of range. Cost:
/// linear.
[[nodiscard]] SDM_API WithoutIslands remove_islands(const Mesh& mesh, const IslandLimits& limits);

}  // namespace sdm
