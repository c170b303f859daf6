#include <sdm/error.h>
#include <sdm/points.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <vector>

#include "core/memory.h"
#include "geometry/affine.h"
#include "geometry/vec.h"
#include "io/points/point_cells.h"

namespace sdm {

using namespace io;

namespace {

// Calls visit(point) for all points of the file with coordinates, as they are in it.
template <class Visit>
void for_each_point(const std::filesystem::path& cloud, const CloudIslandsOptions& options,
                    const Visit& visit) {
  PointReader reader(cloud, options.text);
  std::vector<Vec3> points, normals;
  while (reader.read(options.chunk, points, normals)) {
    for (const Vec3& p : points)
      if (finite(p)) visit(p);
    if (options.progress && !options.progress("islands", 0)) throw Cancelled();
  }
}

PointCells cells_of(const std::filesystem::path& cloud, const CloudIslandsOptions& options) {
  if (options.chunk == 0) throw Error("the number of points in memory must be greater than 0");
  UsualBox usual;
  std::uint64_t count = 0;
  for_each_point(cloud, options, [&](const Vec3& p) {
    usual.add(p);
    ++count;
  });
  PointCells cells(usual.box(), count);
  for_each_point(cloud, options, [&](const Vec3& p) { cells.add(p, 0, {.points = 1}); });
  return cells;
}

// An upper bound of |A v| / |v|: its square is at most the largest sum of the magnitudes of a row of AᵀA, and
// equal to it if the columns of A are orthogonal.
double most_stretch(const Affine& map) {
  std::array<Vec3, 3> columns;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) columns[j][i] = map.rows[i][j];
  double most = 0;
  for (const Vec3& a : columns) {
    double sum = 0;
    for (const Vec3& b : columns) sum += std::abs(dot(a, b));
    most = std::max(most, sum);
  }
  return std::sqrt(most);
}

}  // namespace

struct CloudIslands::Impl {
  PointCells cells;  ///< those of islands
  std::uint64_t islands = 0, points = 0;
};

CloudIslands::CloudIslands(const std::filesystem::path& cloud, std::uint64_t points,
                           const CloudIslandsOptions& options) try
    : impl_(std::make_unique<Impl>(Impl{cells_of(cloud, options)})) {
  impl_->islands = impl_->cells.keep_below(points);
  impl_->points = impl_->cells.points();
} catch (const std::bad_alloc&) {
  throw out_of_memory("the islands of " + cloud.string());
}
CloudIslands::~CloudIslands() = default;
CloudIslands::CloudIslands(CloudIslands&&) noexcept = default;
CloudIslands& CloudIslands::operator=(CloudIslands&&) noexcept = default;

bool CloudIslands::contains(const Vec3& point) const {
  return finite(point) && impl_->cells.contains(point, 0);
}

PointIslands CloudIslands::found(const Transform& placement) const {
  Affine map;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) map.rows[i][j] = placement.rows[i][j];
  return {.islands = impl_->islands,
          .points = impl_->points,
          .apart = impl_->cells.width() / most_stretch(inverse(map)),
          .reach = impl_->cells.reach() * most_stretch(map)};
}

}  // namespace sdm
