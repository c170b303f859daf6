#include "map_task.h"

#include <cmath>
#include <cstdio>

#include "core/vec.h"

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

void MapTask::ask_embree() {
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
  ask_embree();
  Box box = bounds(surface_->mesh());
  extend(box, bounds(sites_.mesh()));
  const double tolerance = 1e-6 * diagonal(box);
  std::size_t wrong = 0;
  double worst = 0;
  for (std::size_t i = 0; i < queries_.size(); ++i) {
    const double error = std::abs(map_.distance[surface_->samples()[i]] - queries_[i].distance);
    wrong += !(error <= tolerance);
    worst = std::fmax(worst, error);
  }
  if (wrong > 0)
    std::fprintf(stderr, "%zu of %zu texels disagree with Embree, by up to %g; allowed is %g\n", wrong,
                 queries_.size(), worst, tolerance);
  return wrong == 0;
}

}  // namespace sdm::bench
