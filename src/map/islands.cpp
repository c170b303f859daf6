#include <sdm/error.h>
#include <sdm/mesh_attributes.h>
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "core/memory.h"

namespace sdm {
namespace {

struct ComponentSize {
  std::size_t faces = 0;
  double area = 0;
};

double area_of(const Mesh& mesh, std::size_t face) {
  const Triangle& t = mesh.triangles[face];
  const Vec3& p = mesh.positions[t[0]];
  return 0.5 * norm(cross(mesh.positions[t[1]] - p, mesh.positions[t[2]] - p));
}

}  // namespace

WithoutIslands remove_islands(const Mesh& mesh, const IslandLimits& limits) try {
  validate(mesh);
  if (!(limits.area >= 0) || !std::isfinite(limits.area))
    throw Error("the area of islands is negative or not finite");
  if (!(limits.area_fraction >= 0 && limits.area_fraction <= 1))
    throw Error("the area of islands is not a fraction from 0 to 1");
  const std::vector<std::uint32_t> components = face_components(mesh);
  std::vector<ComponentSize> sizes;
  double all = 0;
  for (std::size_t f = 0; f < components.size(); ++f) {
    if (components[f] == kNone) continue;
    sizes.resize(std::max<std::size_t>(sizes.size(), components[f] + std::size_t{1}));
    const double area = area_of(mesh, f);
    ++sizes[components[f]].faces;
    sizes[components[f]].area += area;
    all += area;
  }
  const auto is_island = [&](const ComponentSize& size) {
    return size.faces < limits.faces || size.area < limits.area || size.area < limits.area_fraction * all;
  };

  WithoutIslands result;
  result.islands = static_cast<std::size_t>(std::ranges::count_if(sizes, is_island));
  if (result.islands == sizes.size())
    throw Error("every component of the mesh is below the limit of islands");
  result.mesh.positions = mesh.positions;
  for (std::size_t f = 0; f < components.size(); ++f) {
    if (components[f] == kNone) continue;
    if (is_island(sizes[components[f]])) {
      ++result.faces;
      continue;
    }
    result.face.push_back(static_cast<std::uint32_t>(f));
    result.mesh.triangles.push_back(mesh.triangles[f]);
    if (!mesh.corner_uvs.empty()) result.mesh.corner_uvs.push_back(mesh.corner_uvs[f]);
  }
  for (const ComponentSize& size : sizes)
    if (is_island(size)) result.area += size.area;
  result.area_fraction = all > 0 ? result.area / all : 0;
  validate(result.mesh);
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the mesh without its islands");
}

}  // namespace sdm
