#include "map/thickness/thickness_measure.h"

#include <sdm/error.h>

#include "geometry/vec.h"

namespace sdm {
namespace thickness {
namespace {

const Sites& checked(const Mesh& mesh, const Sites& sites) {
  if (mesh.triangles.size() != sites.mesh().triangles.size())
    throw Error("surface and sites belong to different meshes: their numbers of faces differ");
  return sites;
}

class FaceWallSearch final : public map::FaceSearch {
 public:
  FaceWallSearch(const Walls& walls, ThicknessMethod method)
      : walls_(walls), method_(method), search_(walls) {}

  void start(const map::Samples& samples) override {
    points_ = samples.points;
    measured_ = walls_.measures(samples.face);
    if (measured_) search_.start(samples.face, points_);
  }
  map::Value value(std::size_t i) override {
    if (!measured_) return {};
    const WallEnd& ray = search_.rays()[i];
    const WallEnd end = method_ == ThicknessMethod::ray ? ray : search_.ball(points_[i], ray);
    if (end.face == kNone) return {};
    return {.closest = {.point = end.point,
                        .distance = end.thickness,
                        .site = end.face,
                        .type = SiteType::face,
                        .face = end.face},
            .vector = end.point - points_[i]};
  }

 private:
  const Walls& walls_;
  ThicknessMethod method_;
  WallSearch search_;
  bool measured_ = false;
  std::span<const Vec3> points_;
};

}  // namespace

ThicknessMeasure::ThicknessMeasure(const Mesh& mesh, const Sites& sites, const ThicknessOptions& options)
    : walls_(internals(checked(mesh, sites)), options.angle), method_(options.method) {
  description.measured = measured_distance(options);
  description.sign.reason = "a thickness has no sign";
  progress = options.progress;
}

std::unique_ptr<map::FaceSearch> ThicknessMeasure::search() const {
  return std::make_unique<FaceWallSearch>(walls_, method_);
}

}  // namespace thickness

MeasuredDistance measured_distance(const ThicknessOptions& options) {
  return {.kind = DistanceKind::thickness,
          .text = options.method == ThicknessMethod::ball
                      ? "wall thickness, the diameter of the largest ball in the part"
                      : "wall thickness, the length of the ray along the normal into the part",
          .settings = settings_of(options)};
}

}  // namespace sdm
