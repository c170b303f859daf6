#include "map_task.h"

#include <sdm/execution.h>

#include <cmath>
#include <cstdio>

#include "closest/point_group.h"
#include "closest/work_counts.h"
#include "geometry/vec.h"

namespace sdm::bench {

MapTask::MapTask(std::shared_ptr<Surface> o1, const Mesh& o2)
    : surface_(std::move(o1)), sites_(o2), embree_(std::make_unique<EmbreeScene>(o2)) {
  place_queries();
}

void MapTask::place_queries() {
  queries_.clear();
  for (const Vec3& p : surface_->sample_points())
    queries_.push_back(
        {.point = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])}});
}

void MapTask::compute() {
  compute_map(*surface_, sites_, {.sign = SignMethod::none}, map_);
}

void MapTask::compute_with_embree() {
  embree_->closest(queries_);
}

void MapTask::refit(std::span<const Vec3> o1, std::span<const Vec3> o2) {
  surface_->refit(o1);
  place_queries();
  sites_.refit(o2);
  embree_ = std::make_unique<EmbreeScene>(sites_.mesh());
}

bool MapTask::agrees() {
  compute();
  compute_with_embree();
  Box box = bounds(surface_->mesh());
  extend(box, bounds(sites_.mesh()));
  const double tolerance = 1e-6 * diagonal(box);
  std::size_t wrong = 0;
  double worst = 0;
  for (std::size_t i = 0; i < queries_.size(); ++i) {
    const double error = std::abs(map_.distance[surface_->sample_texels()[i]] - queries_[i].distance);
    wrong += !(error <= tolerance);
    worst = std::fmax(worst, error);
  }
  if (wrong > 0)
    std::fprintf(stderr, "%zu of %zu texels differ from Embree's, by up to %g; the tolerance is %g\n", wrong,
                 queries_.size(), worst, tolerance);
  return wrong == 0;
}

bool all_agree(const Tasks& tasks) {
  bool good = true;
  for (MapTask* task : tasks) good &= task->agrees();
  return good;
}

Contender ours(const Tasks& tasks, unsigned threads) {
  return {[tasks] {
            for (MapTask* task : tasks) task->compute();
          },
          threads};
}

Contender embree(const Tasks& tasks, unsigned threads) {
  return {[tasks] {
            for (MapTask* task : tasks) task->compute_with_embree();
          },
          threads};
}

std::vector<Figure> work_figures(const Tasks& tasks) {
  std::size_t texels = 0;
  for (const MapTask* task : tasks) texels += task->texels();
  std::vector<Figure> figures{{"texels", static_cast<double>(texels)}};
  if constexpr (closest::kCountWork) {
    const ThreadLimit this_one(1);  // the counts are those of the calling thread
    closest::work_counts() = {};
    for (MapTask* task : tasks) task->compute();
    const closest::WorkCounts& counts = closest::work_counts();
    const double packets = static_cast<double>(texels) / closest::PointGroup::kPacket;
    for (const auto& [key, count] :
         {std::pair("groups_per_packet", counts.groups), std::pair("nodes_per_packet", counts.nodes),
          std::pair("leaves_per_packet", counts.leaves), std::pair("gathered_per_packet", counts.gathered),
          std::pair("list_blocks_per_packet", counts.list_blocks),
          std::pair("evaluations_per_packet", counts.evaluations)})
      figures.push_back({key, static_cast<double>(count) / packets});
  }
  return figures;
}

}  // namespace sdm::bench
