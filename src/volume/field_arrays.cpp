#include "volume/field_arrays.h"

#include <sdm/error.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <string>

#include "core/memory.h"
#include "core/parallel.h"
#include "volume/grid.h"

namespace sdm::volume {
namespace {

std::string name_of(const Grid& grid) {
  return "a grid of " + std::to_string(grid.dims[0]) + " × " + std::to_string(grid.dims[1]) + " × " +
         std::to_string(grid.dims[2]) + " points";
}

double diagonal_of_scene(const Grid& grid, const Box& o2) {
  Box scene = box_of(grid);
  extend(scene, o2);
  return diagonal(scene);
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
}

}  // namespace

DistanceField new_field(const Sites& o2, const Grid& grid, const NewField& properties) {
  check_grid(grid);
  if (!(properties.max_distance > 0)) throw Error("the maximum distance must be greater than 0");
  DistanceField field;
  field.grid = grid;
  field.max_distance = properties.max_distance;
  field.o2_bounds = bounds(o2.mesh());
  field.accuracy = properties.relative_error * diagonal_of_scene(grid, field.o2_bounds);
  allocate(field, properties.sites, properties.more_bytes_per_point);
  return field;
}

std::size_t bytes_of(const DistanceField& field) {
  return field.distance.size() * sizeof(float) + field.site.size() * sizeof(std::uint32_t) +
         field.site_type.size() * sizeof(SiteType);
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

}  // namespace sdm::volume
