#include <sdm/bake.h>
#include <sdm/error.h>

#include <array>
#include <cmath>
#include <new>
#include <string>

#include "baking/look_reader.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/triangle.h"

namespace sdm {
namespace {

/// The sides of a square in the plane of a face; one without area has none.
std::array<Vec3, 2> square_of(const Mesh& mesh, std::uint32_t face, double extent) {
  const auto [a, b, c] = corners_of(mesh, face);
  const Vec3 normal = cross(b - a, c - a);
  if (!(squared_norm(normal) > 0)) return {};
  const Vec3 x = normalized(b - a), y = normalized(cross(normal, x));
  return {extent * x, extent * y};
}

}  // namespace

LookValues look_at(const Mesh& mesh, const MeshLook& look, BakeChannel channel,
                   std::span<const SurfacePoint> points, double extent) try {
  baking::require_fitting(mesh, look);
  if (!(extent >= 0 && std::isfinite(extent)))
    throw Error("the side of a square must be a number, 0 or more");
  for (const SurfacePoint& point : points)
    if (point.face >= mesh.triangles.size())
      throw Error("a point is on face " + std::to_string(point.face) + " of " +
                  std::to_string(mesh.triangles.size()));
  baking::Pictures pictures(look);
  const baking::ChannelLook of_channel(mesh, look, channel, pictures);
  LookValues result{of_channel.components, std::vector<float>(points.size() * of_channel.components)};
  constexpr std::size_t kPointsOfTask = 4096;
  parallel_for(points.size(), kPointsOfTask, [&](std::size_t begin, std::size_t end) {
    baking::LookReader reader(of_channel);
    for (std::size_t i = begin; i < end; ++i)
      reader.at(points[i], square_of(mesh, points[i].face, extent), &result.values[i * result.components]);
  });
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the look of a mesh");
}

}  // namespace sdm
