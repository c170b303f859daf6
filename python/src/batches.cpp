// Closest points of many meshes in one call.
#include <nanobind/stl/vector.h>
#include <sdm/error.h>
#include <sdm/execution.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "arrays.h"
#include "closest.h"
#include "objects.h"
#include "signatures.h"
#include "sites_in_use.h"

namespace sdm::python {
namespace {

/// The rows of all items, one after the other.
struct BatchRows {
  explicit BatchRows(std::size_t count, bool with_gradients)
      : distance(count),
        point(count),
        face(count),
        barycentric(count),
        site(count),
        type(count),
        corners(count),
        gradient(with_gradients ? count : 0) {}

  std::vector<double> distance;
  std::vector<Vec3> point;
  std::vector<std::uint32_t> face;
  std::vector<Vec3> barycentric;
  std::vector<std::uint32_t> site;
  std::vector<std::uint8_t> type;
  std::vector<Triangle> corners;
  std::vector<Vec3> gradient;
};

struct BatchQuery {
  MapOptions options;
  bool gradients;
};

/// Writes the rows of one item, from `begin` on.
void search_item(const Sites& sites, std::span<const Vec3> points, const BatchQuery& query, BatchRows& rows,
                 std::size_t begin) {
  const Found found = search(sites, points, query.options);
  const Mesh& mesh = sites.mesh();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ClosestPoint& closest = found.closest[i];
    const bool none = closest.type == SiteType::none;
    const std::size_t row = begin + i;
    rows.distance[row] = found.distance_of(i);
    rows.point[row] = none ? kNoPoint : closest.point;
    rows.face[row] = closest.face;
    rows.barycentric[row] = weights_of(sites, mesh.positions, closest);
    rows.site[row] = closest.site;
    rows.type[row] = static_cast<std::uint8_t>(closest.type);
    if (!none) rows.corners[row] = mesh.triangles[closest.face];
    if (query.gradients) rows.gradient[row] = found.gradient_of(i, points[i]);
  }
}

/// Counts items, and reports them from any thread.
class ItemsDone {
 public:
  ItemsDone(const Progress& progress, std::size_t count) : progress_(progress), count_(count) {}
  void add_one() {
    const std::lock_guard lock(mutex_);
    ++done_;
    if (!progress_("closest points", static_cast<double>(done_) / static_cast<double>(count_)))
      throw Cancelled();
  }

 private:
  const Progress& progress_;
  std::size_t count_, done_ = 0;
  std::mutex mutex_;
};

/// Calls item(i), whose errors then name the item.
template <class Item>
void named(std::size_t i, const Item& item) {
  try {
    item(i);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    throw Error("item " + std::to_string(i) + " of the batch: " + error.what());
  }
}

/// Calls work(next) concurrently for as many workers as there are cores; next() is the next item that no
/// worker has, until there are no more.
template <class Work>
void share_items(std::size_t count, const Work& work) {
  std::atomic<std::size_t> taken = 0;
  const auto next = [&]() -> std::optional<std::size_t> {
    const std::size_t i = taken++;
    return i < count ? std::optional(i) : std::nullopt;
  };
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  run_concurrently(std::vector<std::function<void()>>(std::min(count, cores), [&] { work(next); }));
}

nb::object arrays_of(BatchRows&& rows, bool gradients) {
  const std::size_t n = rows.distance.size();
  return nb::make_tuple(
      array_of<double>(std::move(rows.distance), {n}), array_of<double>(std::move(rows.point), {n, 3}),
      array_of<std::uint32_t>(std::move(rows.face), {n}),
      array_of<double>(std::move(rows.barycentric), {n, 3}),
      array_of<std::uint32_t>(std::move(rows.site), {n}), array_of<std::uint8_t>(std::move(rows.type), {n}),
      array_of<std::uint32_t>(std::move(rows.corners), {n, 3}),
      gradients ? array_of<double>(std::move(rows.gradient), {n, 3}) : nb::none());
}

/// The points of all items, and the first row of each.
struct BatchPoints {
  explicit BatchPoints(const std::vector<nb::object>& arrays) {
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      const std::string name = "points[" + std::to_string(i) + "]";
      points.emplace_back(arrays[i], name.c_str());
      begins.push_back(rows);
      rows += points.back().get().size();
    }
  }
  std::vector<Points> points;
  std::vector<std::size_t> begins;
  std::size_t rows = 0;
};

nb::object closest_of_meshes(const std::vector<nb::object>& meshes, const std::vector<nb::object>& arrays,
                             const BatchQuery& query, nb::handle progress) {
  const BatchPoints points(arrays);
  std::vector<std::optional<SitesInUse>> sites(meshes.size());
  for (std::size_t i = 0; i < meshes.size(); ++i) named(i, [&](std::size_t) { sites[i].emplace(meshes[i]); });
  BatchRows rows(points.rows, query.gradients);
  run(progress, [&](const Progress& report) {
    ItemsDone done(report, meshes.size());
    share_items(meshes.size(), [&](const auto& next) {
      while (const auto i = next()) {
        named(*i, [&](std::size_t item) {
          search_item(sites[item]->get(), points.points[item].get(), query, rows, points.begins[item]);
        });
        sites[*i].reset();  // so that few are in memory at a time
        done.add_one();
      }
    });
  });
  return arrays_of(std::move(rows), query.gradients);
}

nb::object closest_of_stack(const std::vector<nb::object>& vertices, nb::handle faces,
                            const std::vector<nb::object>& arrays, const BatchQuery& query,
                            nb::handle progress) {
  const BatchPoints points(arrays);
  std::vector<Points> shapes;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    shapes.emplace_back(vertices[i], ("vertices[" + std::to_string(i) + "]").c_str());
  const std::vector<Triangle> shared = triangles(faces, "the faces");
  BatchRows rows(points.rows, query.gradients);
  run(progress, [&](const Progress& report) {
    ItemsDone done(report, shapes.size());
    share_items(shapes.size(), [&](const auto& next) {
      std::optional<Sites> sites;  // those of the first item, whoever refits them: results do not depend on
                                   // the number of workers
      while (const auto i = next()) {
        if (!sites)
          named(0, [&](std::size_t) {
            const auto first = shapes.front().get();
            sites.emplace(
                Mesh{.positions = {first.begin(), first.end()}, .triangles = shared, .corner_uvs = {}});
          });
        named(*i, [&](std::size_t item) {
          if (item > 0) sites->refit(shapes[item].get());
          search_item(*sites, points.points[item].get(), query, rows, points.begins[item]);
        });
        done.add_one();
      }
    });
  });
  return arrays_of(std::move(rows), query.gradients);
}

}  // namespace

void bind_batches(nb::module_& module) {
  module.def(
      "closest_points_batch",
      [](const std::vector<nb::object>& meshes, nb::handle faces, const std::vector<nb::object>& points,
         double max_distance, const char* sign, bool gradients, nb::handle progress) {
        const BatchQuery query{{.sign = enum_of<SignMethod>("sign", sign), .max_distance = max_distance},
                               gradients};
        return faces.is_none() ? closest_of_meshes(meshes, points, query, progress)
                               : closest_of_stack(meshes, faces, points, query, progress);
      },
      nb::arg("meshes"), nb::arg("faces").none(), nb::arg("points"), nb::kw_only(),
      nb::arg("max_distance") = kInfinity, nb::arg("sign") = "none", nb::arg("gradients") = false,
      nb::arg("progress") = nb::none(),
      nb::sig("def closest_points_batch(meshes: collections.abc.Sequence[object], faces: object, points: "
              "collections.abc.Sequence[object], *, "
              "max_distance: float = ..., sign: " SDM_SIGN " = 'none', gradients: bool = False, progress: "
              "collections.abc.Callable[[str, float], bool | None] | None = None) -> "
              "tuple[typing.Any, ...]"));
}

}  // namespace sdm::python
