#include "map/facing_measure.h"

#include <sdm/closest_points.h>
#include <sdm/error.h>

#include <new>

#include "closest/facing/facing_normals.h"
#include "core/memory.h"
#include "map/closest_measure.h"
#include "sites/sites_data.h"

namespace sdm {
namespace map {
namespace {

class MatchSearch final : public FaceSearch {
 public:
  explicit MatchSearch(const FacingMeasure& measure) : measure_(measure) {}

  void start(std::span<const Sample> samples) override { samples_ = samples; }
  Value value(std::size_t i) override {
    const Sample& sample = samples_[i];
    return measure_.value(sample.point, *sample.normal, *sample.closest);
  }

 private:
  const FacingMeasure& measure_;
  std::span<const Sample> samples_;
};

}  // namespace

FacingMeasure::FacingMeasure(const Sites& sites, const MapOptions& options)
    : search_(internals(sites), *options.facing), max_distance_(options.max_distance) {
  description.measured = measured_distance(options);
  description.sign.method = SignMethod::side;
  progress = options.progress;
}

FacingMeasure::FacingMeasure(const Mesh& mesh, const Sites& sites, const MapOptions& options)
    : FacingMeasure(sites, options) {
  description.sign = choose_sign(sites, options);
  normals = facing::facing_normals(mesh, *options.facing).normals;
}

FacingMeasure::FacingMeasure(const Surface& surface, const Sites& sites, const MapOptions& options)
    : FacingMeasure(sites, options) {
  description.sign = choose_sign(sites, options);
  normals = facing::facing_normals(surface, *options.facing).normals;
}

void FacingMeasure::find_closest(const Sites& sites, const MapOptions& options,
                                 std::span<const Vec3> points) {
  closest = closest_points(sites, points, point_options(options));
}

std::unique_ptr<FaceSearch> FacingMeasure::search() const {
  return std::make_unique<MatchSearch>(*this);
}

Value FacingMeasure::value(const Vec3& point, const Vec3& normal, const ClosestPoint& near) const {
  const facing::Match match = search_.match(point, normal, max_distance_, near);
  return {.closest = match.closest,
          .vector = match.closest.point - point,
          .negative = match.behind && description.sign.method != SignMethod::none,
          .unmatched = match.unmatched};
}

}  // namespace map

FacingPoints closest_facing_points(const Sites& sites, std::span<const Vec3> points,
                                   std::span<const Vec3> normals, double facing,
                                   const ClosestPointOptions& options) try {
  if (normals.size() != points.size()) throw Error("closest_facing_points() needs one normal for each point");
  const MapOptions of_map{.engine = options.engine,
                          .max_distance = options.max_distance,
                          .facing = facing,
                          .progress = options.progress};
  map::FacingMeasure measure(sites, of_map);
  measure.find_closest(sites, of_map, points);
  return map::measure_points(points, normals, measure);
} catch (const std::bad_alloc&) {
  throw out_of_memory("closest points of faces that face the queries");
}

}  // namespace sdm
