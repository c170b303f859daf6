#include "volume/field_by_engine.h"

#include <algorithm>

#include "closest/blocks.h"
#include "core/cancellation.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "geometry/spatial_order.h"
#include "geometry/vec.h"
#include "inside/inside.h"
#include "volume/field_arrays.h"
#include "volume/field_writer.h"
#include "volume/grid.h"

namespace sdm::volume {
namespace {

using Index3 = std::array<std::uint32_t, 3>;

constexpr int kBrickBits = 12, kCellBits = 6;  // points of a brick and of a cell: powers of two
constexpr std::size_t kEnoughBricks = 32;      // to distribute over the cores

// Bricks of neighbouring points, in the order of a space-filling curve that follows the spacings: every
// aligned 16, 64, 256, ... points of a brick lie in a box that is as close to a cube as the grid allows.
struct Bricks {
  Index3 dims;                  // of the grid
  Index3 size{1, 1, 1};         // points of a brick along each axis
  Index3 cell{1, 1, 1};         // and of a cell, the first and every further 1 << kCellBits points
  Index3 count{};               // bricks along each axis
  std::vector<Index3> offsets;  // of the points of a brick, in order

  explicit Bricks(const Grid& grid) : dims(grid.dims) {
    std::vector<int> axes;  // of the bits of a point's place in the order, the lowest first
    while (axes.size() < kBrickBits && (grid.size() >> axes.size()) > kEnoughBricks) {
      int shortest = -1;
      for (int k = 0; k < 3; ++k)
        if (size[k] < dims[k] &&
            (shortest < 0 || size[k] * grid.spacing[k] < size[shortest] * grid.spacing[shortest]))
          shortest = k;
      if (shortest < 0) break;
      size[shortest] *= 2;
      if (axes.size() < kCellBits) cell[shortest] *= 2;
      axes.push_back(shortest);
    }
    for (int k = 0; k < 3; ++k) count[k] = (dims[k] + size[k] - 1) / size[k];
    offsets.resize(std::size_t{1} << axes.size());
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      Index3 bits{};
      for (std::size_t b = 0; b < axes.size(); ++b) {
        const int k = axes[b];
        offsets[i][k] |= static_cast<std::uint32_t>(i >> b & 1) << bits[k];
        ++bits[k];
      }
    }
  }

  [[nodiscard]] std::size_t total() const { return std::size_t{count[0]} * count[1] * count[2]; }
  [[nodiscard]] Index3 first_point(std::size_t brick) const {
    const std::size_t plane = std::size_t{count[0]} * count[1];
    return {static_cast<std::uint32_t>(brick % count[0]) * size[0],
            static_cast<std::uint32_t>(brick % plane / count[0]) * size[1],
            static_cast<std::uint32_t>(brick / plane) * size[2]};
  }
  [[nodiscard]] bool contains(const Index3& p) const {
    return p[0] < dims[0] && p[1] < dims[1] && p[2] < dims[2];
  }
};

// The centre of a block of points, and the distance to the farthest of them.
struct Ball {
  Vec3 centre;
  double radius;
};

Ball ball_of(const Grid& grid, const Index3& first, const Index3& size) {
  Index3 last;
  for (int k = 0; k < 3; ++k) last[k] = std::min(first[k] + size[k], grid.dims[k]) - 1;
  const Vec3 lo = grid.point(first[0], first[1], first[2]), hi = grid.point(last[0], last[1], last[2]);
  return {0.5 * (lo + hi), 0.5 * norm(hi - lo)};
}

// Finds which balls may contain points within the maximum distance.
class NearBalls {
 public:
  NearBalls(const FieldTask& task, const Engine& engine) : task_(task), engine_(engine) {
    Box scene = box_of(task.grid);
    extend(scene, bounds(task.sites.mesh));
    slack_ = 2 * engine.info().relative_error * diagonal(scene);
  }

  /// near[i]: whether ball i may.
  void find(std::span<const Ball> balls, std::vector<std::uint8_t>& near) const {
    thread_local std::vector<Vec3> centres;
    centres.clear();
    double radius = 0;
    for (const Ball& ball : balls) {
      centres.push_back(ball.centre);
      radius = std::max(radius, ball.radius);
    }
    near.assign(balls.size(), 0);
    const double reach = task_.options.max_distance + slack_;
    engine_.closest_points(
        task_.o2, centres, reach + radius, [&](std::size_t first, const sites::ClosestPacket& closest) {
          for (std::size_t i = 0; i < closest.count; ++i)
            near[first + i] =
                closest.type[i] != SiteType::none && closest.distance[i] <= reach + balls[first + i].radius;
        });
  }

 private:
  const FieldTask& task_;
  const Engine& engine_;
  double slack_;
};

// The bricks that may be near, in an order in which neighbours are near each other.
std::vector<std::size_t> near_bricks(const Bricks& bricks, const Grid& grid, const NearBalls& near_balls) {
  std::vector<Ball> balls(bricks.total());
  std::vector<Vec3> centres(bricks.total());
  Poll poll(1 << 12);
  for (std::size_t b = 0; b < balls.size(); ++b) {
    poll();
    balls[b] = ball_of(grid, bricks.first_point(b), bricks.size);
    centres[b] = balls[b].centre;
  }
  const std::vector<std::uint32_t> order = spatial_order(centres);
  std::vector<std::uint8_t> is_near(bricks.total());
  closest::for_each_block(order.size(), {}, {}, [&](std::size_t begin, std::size_t end) {
    std::vector<Ball> block;
    for (std::size_t i = begin; i < end; ++i) block.push_back(balls[order[i]]);
    std::vector<std::uint8_t> near;
    near_balls.find(block, near);
    std::ranges::copy(near, is_near.begin() + static_cast<std::ptrdiff_t>(begin));
  });
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < order.size(); ++i)
    if (is_near[i] != 0) result.push_back(order[i]);
  return result;
}

// The points of a brick that are queried.
struct Queries {
  std::vector<Vec3> points;
  std::vector<std::size_t> indices;  // in the grid
  std::vector<Ball> cells;
  std::vector<std::size_t> cell_starts;
  std::vector<std::uint8_t> near;

  void clear() {
    points.clear();
    indices.clear();
    cells.clear();
    cell_starts.clear();
  }
  void add(const Bricks& bricks, const Grid& grid, const Index3& first, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index3& o = bricks.offsets[i];
      const Index3 p{first[0] + o[0], first[1] + o[1], first[2] + o[2]};
      if (!bricks.contains(p)) continue;
      points.push_back(grid.point(p[0], p[1], p[2]));
      indices.push_back(grid.index(p[0], p[1], p[2]));
    }
  }
  // The cells of a brick that may contain points within the maximum distance.
  void add_near(const Bricks& bricks, const Grid& grid, const Index3& first, const NearBalls& near_balls) {
    const std::size_t step = std::min(std::size_t{1} << kCellBits, bricks.offsets.size());
    for (std::size_t i = 0; i < bricks.offsets.size(); i += step) {
      const Index3& o = bricks.offsets[i];
      const Index3 p{first[0] + o[0], first[1] + o[1], first[2] + o[2]};
      if (!bricks.contains(p)) continue;
      cells.push_back(ball_of(grid, p, bricks.cell));
      cell_starts.push_back(i);
    }
    near_balls.find(cells, near);
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (near[c] != 0) add(bricks, grid, first, cell_starts[c], cell_starts[c] + step);
  }
};

// Finds the closest sites of all points by the engine; signed, if asked for. With `only_near`, points that
// are surely beyond the maximum distance are skipped: cells of neighbouring points whose centre is farther
// from O2 than the maximum distance and the radius of the cell. Returns the bytes of working memory, an
// estimate.
std::size_t query_grid(const FieldTask& task, const Engine& engine, bool only_near, DistanceField& field) {
  const Grid& grid = task.grid;
  const Bricks bricks(grid);
  const NearBalls near_balls(task, engine);
  const FieldWriter writer(field);
  const std::vector<std::size_t> near =
      only_near ? near_bricks(bricks, grid, near_balls) : std::vector<std::size_t>();
  const std::size_t count = only_near ? near.size() : bricks.total();
  parallel_for(count, 1, task.options.progress, "field", [&](std::size_t begin, std::size_t end) {
    thread_local Queries queries;
    for (std::size_t b = begin; b < end; ++b) {
      const Index3 first = bricks.first_point(only_near ? near[b] : b);
      queries.clear();
      if (only_near)
        queries.add_near(bricks, grid, first, near_balls);
      else
        queries.add(bricks, grid, first, 0, bricks.offsets.size());
      if (queries.points.empty()) continue;
      engine.closest_points(
          task.o2, queries.points, task.options.max_distance,
          [&](std::size_t at, const sites::ClosestPacket& closest) {
            const std::uint32_t inside =
                task.is_signed ? task.is_inside(std::span(queries.points).subspan(at, closest.count), closest)
                               : 0;
            for (std::size_t i = 0; i < closest.count; ++i) {
              if (closest.type[i] == SiteType::none) continue;
              const auto d = static_cast<float>(closest.distance[i]);
              const std::size_t index = queries.indices[at + i];
              writer.distance(index, (inside >> i & 1) != 0 ? -d : d);
              writer.site(index, closest.type[i], closest.site[i]);
            }
          });
    }
  });
  return near.capacity() * sizeof(std::size_t) + bricks.total() +
         thread_count() * bricks.offsets.size() * (sizeof(Vec3) + sizeof(std::size_t));
}

}  // namespace

DistanceField field_by_engine(const Sites& sites, const Grid& grid, const FieldOptions& options,
                              const Engine& engine, bool only_near, FieldReport& report) {
  const SignUsed sign = choose_sign(sites, options.sign);
  DistanceField field = new_field(sites, grid,
                                  {.max_distance = options.max_distance,
                                   .sites = options.sites,
                                   .relative_error = engine.info().relative_error});
  field.sign = sign;
  Stopwatch watch;
  const sites::SitesData& data = internals(sites);
  const inside::InsideTest is_inside(data, sign.method, field.accuracy);
  const FieldTask task{sites, data, grid, options, is_inside, sign.method != SignMethod::none};
  report.working_bytes = query_grid(task, engine, only_near, field);
  report.milliseconds = watch.lap();
  report.field_bytes = bytes_of(field);
  field.beyond_max_distance = count_without_value(field.distance);
  return field;
}

}  // namespace sdm::volume
