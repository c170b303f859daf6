#include "io/points/cloud_islands.h"

#include <sdm/error.h>

#include <cmath>
#include <vector>

#include "geometry/vec.h"

namespace sdm::io {
namespace {

// Calls visit(point) for all points of the file with coordinates, as they are in it.
template <class Visit>
void for_each_point(const std::string& cloud, const PointDistancesOptions& options, const Visit& visit) {
  PointReader reader(cloud, options.text);
  std::vector<Vec3> points, normals;
  while (reader.read(options.chunk, points, normals)) {
    for (const Vec3& p : points)
      if (finite(p)) visit(p);
    if (options.map.progress && !options.map.progress("islands", 0)) throw Cancelled();
  }
}

PointCells cells_of(const std::string& cloud, const PointDistancesOptions& options) {
  UsualBox usual;
  std::uint64_t count = 0;
  for_each_point(cloud, options, [&](const Vec3& p) { usual.add(p), ++count; });
  PointCells cells(usual.box(), count);
  for_each_point(cloud, options, [&](const Vec3& p) { cells.add(p, 0, {.points = 1}); });
  return cells;
}

}  // namespace

CloudIslands::CloudIslands(const std::string& cloud, const PointDistancesOptions& options)
    : cells_(cells_of(cloud, options)) {
  found_.islands = cells_.keep_below(options.island_points);
  found_.reach = cells_.reach() * std::cbrt(std::abs(options.placement.determinant()));
}

bool CloudIslands::has(const Vec3& point) const {
  return finite(point) && cells_.contains(point, 0);
}

}  // namespace sdm::io
