#include "visible_texels.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "embree_mesh.h"
#include "io/write/gutter.h"

namespace sdm::bench {
namespace {

using namespace io;

Vec3 face_normal(const Mesh& mesh, const Triangle& face) {
  const Vec3& a = mesh.positions[face[0]];
  return normalized(cross(mesh.positions[face[1]] - a, mesh.positions[face[2]] - a));
}

/// The mesh without the faces whose outside faces the eye. These become degenerate, so that the others keep
/// their indices.
Mesh without_near_side(Mesh mesh, const Vec3& eye) {
  for (Triangle& face : mesh.triangles)
    if (dot(face_normal(mesh, face), eye - mesh.positions[face[0]]) > 0) face[1] = face[2] = face[0];
  return mesh;
}

std::uint32_t texel_at(const Surface& surface, const Gutter& gutter, std::uint32_t face, const Vec3& point) {
  const Vec2 uv = surface.to_atlas(face, point);
  const auto clamped = [&](double x) {
    return static_cast<std::uint32_t>(std::clamp(x, 0.0, static_cast<double>(surface.resolution() - 1)));
  };
  return gutter.source(clamped(uv[0]), clamped(uv[1]));
}

}  // namespace

std::vector<Seen> visible_texels(const View& view, std::span<const Shown> objects) {
  const DeviceHandle device(rtcNewDevice(nullptr));
  const SceneHandle scene(rtcNewScene(device.get()));
  std::vector<Gutter> gutters;
  for (const auto& [surface, only_inside] : objects) {  // geometry ids count up from 0
    attach(device.get(), scene.get(),
           only_inside ? without_near_side(surface->mesh(), view.eye) : surface->mesh());
    gutters.emplace_back(surface->resolution(), surface->texel_faces());
  }
  rtcCommitScene(scene.get());

  const Vec3 forward = normalized(view.target - view.eye);
  const Vec3 right = normalized(cross(forward, view.up)), up = cross(right, forward);
  const double pixel = 2 * std::tan(view.field_of_view * std::numbers::pi / 360) / view.height;

  std::vector<Seen> seen(std::size_t{view.width} * view.height);
  parallel_for(view.height, 8, [&](std::size_t first_row, std::size_t last_row) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (std::size_t i = first_row * view.width; i < last_row * view.width; ++i) {
      const std::size_t column = i % view.width, row = i / view.width;
      const double x = static_cast<double>(column) + 0.5 - 0.5 * view.width;
      const double y = 0.5 * view.height - static_cast<double>(row) - 0.5;
      const Vec3 ray = normalized(forward + pixel * (x * right + y * up));

      RTCRayHit query{};
      query.ray.org_x = static_cast<float>(view.eye[0]), query.ray.dir_x = static_cast<float>(ray[0]);
      query.ray.org_y = static_cast<float>(view.eye[1]), query.ray.dir_y = static_cast<float>(ray[1]);
      query.ray.org_z = static_cast<float>(view.eye[2]), query.ray.dir_z = static_cast<float>(ray[2]);
      query.ray.tfar = std::numeric_limits<float>::infinity();
      query.ray.mask = ~0u;
      query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene.get(), &context, &query);
      if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;

      const Surface& surface = *objects[query.hit.geomID].surface;
      const std::uint32_t face = query.hit.primID;
      const Vec3 point = view.eye + query.ray.tfar * ray;
      const double cosine = std::abs(dot(face_normal(surface.mesh(), surface.mesh().triangles[face]), ray));
      seen[i] = {query.hit.geomID, texel_at(surface, gutters[query.hit.geomID], face, point),
                 static_cast<float>(cosine)};
    }
  });
  return seen;
}

}  // namespace sdm::bench
