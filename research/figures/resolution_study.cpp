#include "research/figures/resolution_study.h"

#include <sdm/sampling_bound.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/vec.h"
#include "surface/sampling_bound/sample_tree.h"

namespace sdm::figures {
namespace {

void add_row(Method& method, double n, double bytes, double bound, const SurfaceErrors& errors, double unit,
             Times times) {
  method.n.push_back(n);
  method.bytes.push_back(bytes);
  method.bound.push_back(bound / unit);
  method.nearest.push_back(errors.nearest / unit);
  method.linear.push_back(errors.linear / unit);
  method.times.push_back(std::move(times));
}

}  // namespace

SurfaceErrors errors_of_map(const Surface& surface, const DistanceMap& map, const SurfacePoints& points) {
  constexpr double kRunRadius = 8;  // in texels
  const surface::SampleTree samples(
      surface, kRunRadius * norm(surface.texel_edges(surface.map_faces()[surface.sample_texels()[0]])[0]));
  SurfaceErrors errors;
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    const std::uint32_t t = surface.sample_texels()[samples.nearest(points.points[i])];
    const Vec3f& v = map.vector[t];
    const Vec3 closest = surface.texel_point(t) + Vec3{v[0], v[1], v[2]};
    const double exact = points.distances[i];
    errors.nearest = std::max(errors.nearest, std::abs(std::abs(map.distance[t]) - exact));
    errors.linear = std::max(errors.linear, std::abs(norm(closest - points.points[i]) - exact));
  }
  return errors;
}

SurfaceErrors errors_of_field(const DistanceField& field, const SurfacePoints& points) {
  const std::vector<FieldSample> samples = sample_field(field, points.points);
  const Grid& grid = field.grid;
  SurfaceErrors errors;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double exact = points.distances[i];
    std::array<std::uint32_t, 3> nearest;
    for (int k = 0; k < 3; ++k)
      nearest[k] = static_cast<std::uint32_t>(std::clamp(
          std::round((points.points[i][k] - grid.origin[k]) / grid.spacing[k]), 0.0, grid.dims[k] - 1.0));
    const double value = std::abs(field.distance[grid.index(nearest[0], nearest[1], nearest[2])]);
    if (std::isfinite(value)) errors.nearest = std::max(errors.nearest, std::abs(value - exact));
    if (std::isfinite(samples[i].value))
      errors.linear = std::max(errors.linear, std::abs(std::abs(samples[i].value) - exact));
  }
  return errors;
}

double bytes_of(const DistanceMap& map) {
  return static_cast<double>(map.distance.size()) *
         (sizeof(float) + sizeof(Vec3f) + sizeof(std::uint32_t) + sizeof(SiteType));
}

std::vector<double> Method::medians() const {
  std::vector<double> ms;
  for (const Times& t : times) ms.push_back(t.median());
  return ms;
}

Json Method::json() const {
  Json rows = Json::array();
  for (std::size_t i = 0; i < n.size(); ++i)
    rows.push_back({{"n", n[i]},
                    {"bytes", bytes[i]},
                    {"error_bound", bound[i]},
                    {"error_nearest", nearest[i]},
                    {"error_linear", linear[i]},
                    {"time_ms", to_json(times[i])}});
  return {{"rows", rows},
          {"exponents",
           {{"bytes", fitted_exponent(n, bytes)},
            {"error_bound", fitted_exponent(n, bound)},
            {"error_nearest", fitted_exponent(n, nearest)},
            {"error_linear", fitted_exponent(n, linear)}}},
          {"time_exponent_ms", fitted_exponent(n, medians())}};
}

Method study_maps(Run& run, const Study& study, const std::shared_ptr<const Engine>& engine,
                  const std::vector<std::uint32_t>& resolutions) {
  Method method{.key = engine ? "map_gl" : "map_cpu", .name = engine ? "map, gl engine" : "map, cpu engine"};
  for (const std::uint32_t n : resolutions) {
    run.step("table_complexity");
    const Surface surface(study.o1, {.resolution = n});
    DistanceMap map;
    Times times =
        repeat([&] { compute_map(surface, study.sites, {.engine = engine, .sign = SignMethod::none}, map); },
               run.choose(5, 2));
    add_row(method, n, bytes_of(map), SamplingBound(surface).value(),
            errors_of_map(surface, map, study.points), study.unit, std::move(times));
  }
  return method;
}

Method study_volumes(Run& run, const Study& study, fields::Method kind,
                     const std::vector<std::uint32_t>& resolutions) {
  const std::string name(fields::info(kind).name);
  Method method{.key = "volume_" + name, .name = "volume, " + name};
  for (const std::uint32_t n : resolutions) {
    run.step("table_complexity");
    const Grid grid = make_grid(with_room(bounds(study.o1)), {n, n, n});
    fields::Field field;
    Times times = repeat(
        [&] { field = fields::compute_field(study.sites, grid, {.method = kind, .sign = SignMethod::none}); },
        run.choose(3, 1), n <= 32);
    add_row(method, n, static_cast<double>(field.report.field_bytes), interpolation_error(grid),
            errors_of_field(field, study.points), study.unit, std::move(times));
  }
  return method;
}

Box with_room(Box box) {
  const double room = 0.01 * diagonal(box);
  for (int k = 0; k < 3; ++k) {
    box.lower[k] -= room;
    box.upper[k] += room;
  }
  return box;
}

}  // namespace sdm::figures
