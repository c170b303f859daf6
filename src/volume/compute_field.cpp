#include <sdm/error.h>
#include <sdm/volume.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>
#include <string>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "engine/cpu/cpu_engine.h"
#include "engine/reference/reference_engine.h"
#include "volume/grid.h"
#include "volume/grid_queries.h"
#include "volume/scan_convert.h"
#include "volume/site_signs.h"
#include "volume/sweep_slices.h"

namespace sdm {
namespace {

using namespace volume;

void check_options(const FieldOptions& options, const FieldMethodInfo& method) {
  if (!(options.band > 0)) throw Error("the band must be greater than 0");
  if (method.needs_band && options.band == std::numeric_limits<double>::infinity())
    throw Error("the method " + std::string(method.name) + " needs a band");
  if (!(options.tessellation >= 0)) throw Error("the tessellation must not be negative");
  if (options.tessellation == 0) return;
  if (method.method != FieldMethod::brute_force)
    throw Error("distance functions are drawn as meshes by the method brute_force only, not by " +
                std::string(method.name));
  if (options.sign != SignMethod::automatic && options.sign != SignMethod::none)
    throw Error("distances of distance functions that are drawn as meshes have no sign");
}

SignUsed sign_of_field(const Sites& sites, const FieldOptions& options) {
  if (options.tessellation > 0)
    return {SignMethod::none,
            "distance functions are drawn as meshes, and what is drawn closest need not be"};
  return choose_sign(sites, options.sign);
}

// The error of the closest points that signs are decided from.
double length_of_error(const FieldMethodInfo& method, const Grid& grid, const Mesh& mesh) {
  Box scene = box_of(grid);
  extend(scene, bounds(mesh));
  return method.relative_error * diagonal(scene);
}

std::string name_of(const Grid& grid) {
  return "a grid of " + std::to_string(grid.dims[0]) + " × " + std::to_string(grid.dims[1]) + " × " +
         std::to_string(grid.dims[2]) + " points";
}

void allocate(DistanceField& field, bool with_sites, std::size_t more_bytes_per_point) {
  const std::size_t count = field.grid.size();
  const std::size_t bytes = sizeof(float) + (with_sites ? sizeof(std::uint32_t) + sizeof(SiteType) : 0);
  static_assert(sizeof(float) + 2 * sizeof(std::uint32_t) + sizeof(SiteType) < 16);  // for up to 2^60 points
  require_memory(count * (bytes + more_bytes_per_point), name_of(field.grid));
  field.distance.assign(count, std::numeric_limits<float>::quiet_NaN());
  if (with_sites) {
    field.site.assign(count, kNone);
    field.site_type.assign(count, SiteType::none);
  }
  field.report.field_bytes = count * bytes;
}

std::size_t count_without_value(std::span<const float> distances) {
  std::atomic<std::size_t> total{0};
  parallel_for(distances.size(), std::size_t{1} << 18, [&](std::size_t begin, std::size_t end) {
    total += static_cast<std::size_t>(std::count_if(distances.begin() + static_cast<std::ptrdiff_t>(begin),
                                                    distances.begin() + static_cast<std::ptrdiff_t>(end),
                                                    [](float d) { return d != d; }));
  });
  return total;
}

}  // namespace

DistanceField compute_field(const Sites& sites, const Grid& grid, const FieldOptions& options) try {
  check_grid(grid);
  const FieldMethodInfo& method = field_method(options.method);
  check_options(options, method);
  DistanceField field;
  field.grid = grid;
  field.band = options.band;
  field.sign = sign_of_field(sites, options);
  field.report.method = options.method;
  field.o2_bounds = bounds(sites.mesh());
  field.accuracy = length_of_error(method, grid, sites.mesh()) + options.tessellation;
  const bool is_signed = field.sign.method != SignMethod::none;
  const bool by_engine = options.method == FieldMethod::best || options.method == FieldMethod::reference;
  const bool by_winners = !by_engine && (is_signed || options.sites);
  allocate(field, options.sites, by_winners ? sizeof(std::uint32_t) : 0);

  Stopwatch watch;
  const sites::SitesData& data = internals(sites);
  const inside::InsideTest is_inside(data, field.sign.method, field.accuracy);
  const FieldTask task{sites, data, grid, options, is_inside, is_signed};
  std::vector<std::uint32_t> winners;  // for signs and sites
  if (by_winners) winners.assign(grid.size(), kNone);
  switch (options.method) {
    case FieldMethod::best:
      field.report.working_bytes =
          query_grid(task, cpu::CpuEngine(), options.band < std::numeric_limits<double>::infinity(), field);
      break;
    case FieldMethod::reference:
      field.report.working_bytes = query_grid(task, reference::ReferenceEngine(), false, field);
      break;
    case FieldMethod::csc:
      scan_convert(task, field, winners);
      break;
    default:
      sweep_slices(task, field, winners);
  }
  field.report.milliseconds = watch.lap();
  if (by_winners) {
    field.report.working_bytes += winners.size() * sizeof(std::uint32_t);
    store_sites(task, winners, field);
    field.report.sign_milliseconds = watch.lap();
  }
  field.beyond_band = count_without_value(field.distance);
  return field;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a distance field");
}

}  // namespace sdm
