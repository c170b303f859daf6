#include "volume/field_arrays.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <string>
#include <vector>

#include "core/cancellation.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"
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

// As assign(), which for gigabytes takes seconds, with polls: pages are made when they are first written.
template <class T>
void fill(std::vector<T>& items, std::size_t count, T value) {
  constexpr std::size_t kPart = std::size_t{1} << 22;
  items.clear();
  items.reserve(count);
  while (items.size() < count) {
    poll();
    items.resize(std::min(items.size() + kPart, count), value);
  }
}

void allocate(DistanceField& field, bool with_sites, std::size_t more_bytes_per_point) {
  const std::size_t count = field.grid.size();
  const std::size_t bytes = sizeof(float) + (with_sites ? sizeof(std::uint32_t) + sizeof(SiteType) : 0);
  static_assert(sizeof(float) + 2 * sizeof(std::uint32_t) + sizeof(SiteType) < 16);  // for up to 2^60 points
  require_memory(count * (bytes + more_bytes_per_point), name_of(field.grid));
  fill(field.distance, count, std::numeric_limits<float>::quiet_NaN());
  if (with_sites) {
    fill(field.site, count, kNone);
    fill(field.site_type, count, SiteType::none);
  }
}

}  // namespace

DistanceField new_field(const Sites& o2, const Grid& grid, const NewField& properties) {
  check_grid(grid);
  check_options(FieldOptions{.max_distance = properties.max_distance});
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
