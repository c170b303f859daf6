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

  void start(std::span<const map::Sample> samples) override { samples_ = samples; }
  map::Value value(std::size_t i) override {
    const map::Sample& sample = samples_[i];
    if (!walls_.measures(sample.face)) return {};
    const WallEnd end = method_ == ThicknessMethod::ray ? search_.ray(sample.face, sample.point)
                                                        : search_.ball(sample.face, sample.point);
    if (end.face == kNone) return {};
    return {.closest = {.point = end.point,
                        .distance = end.thickness,
                        .site = end.face,
                        .type = SiteType::face,
                        .face = end.face},
            .vector = end.point - sample.point};
  }

 private:
  const Walls& walls_;
  ThicknessMethod method_;
  WallSearch search_;
  std::span<const map::Sample> samples_;
};

}  // namespace

ThicknessMeasure::ThicknessMeasure(const Mesh& mesh, const Sites& sites, const ThicknessOptions& options)
    : walls_(internals(checked(mesh, sites)), options.angle), method_(options.method) {
  description.measured = measured_distance(options);
  description.sign.reason = "a thickness has no sign";
  progress = options.progress;
  // Faces in the order of the tree: those that follow each other are near each other.
  groups.assign(mesh.triangles.size(), kNone);
  std::uint32_t place = 0;
  for (const std::uint32_t face : internals(sites).tree.items) groups[face] = place++;
  for (std::uint32_t& group : groups)
    if (group == kNone) group = place++;  // of ignored faces
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
