// Closest points of any points, their signs, and rays.
#include "module/points.h"

#include <sdm/closest_points.h>
#include <sdm/rays.h>
#include <sdm/sites.h>

#include "module/arguments.h"
#include "module/options.h"
#include "module/result.h"

namespace sdm::js {

namespace {

/// Barycentric coordinates are those of corners 1 and 2.
void put_closest(Result& result, const Sites& sites, std::span<const Vec3> queries,
                 const std::vector<ClosestPoint>& closest) {
  const std::size_t count = closest.size();
  std::vector<Vec3> points(count);
  std::vector<double> distances(count), barycentric(2 * count);
  std::vector<std::uint32_t> faces(count);
  for (std::size_t i = 0; i < count; ++i) {
    const ClosestPoint& one = closest[i];
    const bool found = one.type != SiteType::none;
    points[i] = found ? one.point : Vec3{NAN, NAN, NAN};
    distances[i] = one.distance;
    const SurfacePoint on = found ? point_on_face(sites, one.type, one.site, queries[i]) : SurfacePoint{};
    faces[i] = on.face;
    barycentric[2 * i] = on.barycentric[1];
    barycentric[2 * i + 1] = on.barycentric[2];
  }
  result.put("points", std::move(points));
  result.put("distances", std::move(distances));
  result.put("faces", std::move(faces));
  result.put("barycentric", std::move(barycentric));
}

}  // namespace

SDM_EXPORT(sdm_closest_points)
Result* closest_points(const Sites* sites, const double* data, std::uint32_t count, const char* lines,
                       std::uint32_t bytes, const double* numbers) {
  return guarded([&](Result& result) {
    auto options = read_options<ClosestPointOptions>({lines, bytes, numbers});
    options.progress = host_progress();
    const auto queries = points(data, count);
    const auto closest = sdm::closest_points(*sites, queries, options);
    put_closest(result, *sites, queries, closest);
  });
}

SDM_EXPORT(sdm_signed_distance)
Result* signed_distance(const Sites* sites, const double* data, std::uint32_t count, const char* lines,
                        std::uint32_t bytes, const double* numbers) {
  return guarded([&](Result& result) {
    const auto options = read_options<SignedDistanceOptions>({lines, bytes, numbers});
    const auto queries = points(data, count);
    const SignUsed used = choose_sign(*sites, options.sign);
    const auto closest = sdm::closest_points(*sites, queries, {.progress = host_progress()});
    const auto inside = inside_flags(*sites, queries, closest, used.method);
    std::vector<double> distances(count);
    for (std::size_t i = 0; i < count; ++i)
      distances[i] = inside[i] ? -closest[i].distance : closest[i].distance;
    result.put("distances", std::move(distances));
    result.put("sign", used.method);
    result.put("reason", used.reason);
  });
}

/// Origins and directions, three numbers each. Barycentric coordinates are those of corners 1 and 2.
SDM_EXPORT(sdm_first_hits)
Result* first_hits(const Sites* sites, const double* origins, const double* directions, std::uint32_t count,
                   const char* lines, std::uint32_t bytes, const double* numbers) {
  return guarded([&](Result& result) {
    std::vector<Ray> rays(count, read_options<Ray>({lines, bytes, numbers}));
    const auto from = points(origins, count), along = points(directions, count);
    for (std::size_t i = 0; i < count; ++i) {
      rays[i].origin = from[i];
      rays[i].direction = along[i];
    }
    const std::vector<RayHit> hits = sdm::first_hits(*sites, rays, {.progress = host_progress()});
    std::vector<double> t(count), barycentric(2 * count);
    std::vector<std::uint32_t> faces(count);
    for (std::size_t i = 0; i < count; ++i) {
      t[i] = hits[i].t;
      faces[i] = hits[i].face;
      barycentric[2 * i] = hits[i].barycentric[1];
      barycentric[2 * i + 1] = hits[i].barycentric[2];
    }
    result.put("t", std::move(t));
    result.put("faces", std::move(faces));
    result.put("barycentric", std::move(barycentric));
  });
}

}  // namespace sdm::js
