#include "map/self/self_measure.h"

#include <sdm/error.h>

#include <algorithm>
#include <limits>

#include "geometry/vec.h"

namespace sdm::self {
namespace {

const Exclusion& checked(const Mesh& mesh, const Sites& sites, const SelfOptions& options) {
  if (sites.mesh().triangles.size() != options.exclusion.faces())
    throw Error("the exclusion belongs to another mesh: its number of faces differs");
  check_options(SelfProximityOptions{.max_distance = options.max_distance});
  if (mesh.triangles.size() != options.exclusion.faces())
    throw Error("surface and sites belong to different meshes: their numbers of faces differ");
  return options.exclusion;
}

class FaceSelfSearch final : public map::FaceSearch {
 public:
  FaceSelfSearch(const sites::SitesData& sites, const Exclusion& exclusion, const PatchTree& patches,
                 double max_distance)
      : search_(sites, exclusion, patches), max_distance_(max_distance) {}

  void start(std::span<const map::Sample> samples) override {
    samples_ = samples;
    found_.clear();
    for (std::size_t i = 0; i < samples.size(); i += SelfSearch::kPacket) {
      points_.clear();
      faces_.clear();
      for (const map::Sample& s : samples.subspan(i, std::min(SelfSearch::kPacket, samples.size() - i))) {
        points_.push_back(s.point);
        faces_.push_back(s.face);
      }
      search_.start_from(faces_);
      const std::span<const ClosestPoint> found = search_.closest_to(points_, max_distance_);
      found_.insert(found_.end(), found.begin(), found.end());
    }
  }
  map::Value value(std::size_t i) override {
    map::Value value{.closest = found_[i]};
    value.vector = value.closest.point - samples_[i].point;
    return value;
  }

 private:
  SelfSearch search_;
  double max_distance_;
  std::span<const map::Sample> samples_;
  std::vector<Vec3> points_;          // of a packet
  std::vector<std::uint32_t> faces_;  // of these
  std::vector<ClosestPoint> found_;   // of all samples
};

}  // namespace

SelfMeasure::SelfMeasure(const Mesh& mesh, const Sites& sites, const SelfOptions& options)
    : sites_(internals(sites)),
      exclusion_(checked(mesh, sites, options)),
      max_distance_(options.max_distance),
      patches_(sites_, exclusion_) {
  description = {.measured = {.kind = DistanceKind::self,
                              .text = "distance to the closest point of faces that are not excluded",
                              .settings = settings_of(SelfProximityOptions{.max_distance = max_distance_})},
                 .sign = {SignMethod::none, "the distance of a surface to itself has no sign"},
                 .no_value = {.distance = std::numeric_limits<float>::infinity(), .vector = 0}};
  progress = options.progress;
  // The faces of a patch exclude the same.
  std::vector<std::uint32_t> place(exclusion_.patches());
  for (std::uint32_t i = 0; i < place.size(); ++i) place[patches_.order[i]] = i;
  groups.resize(exclusion_.faces());
  for (std::uint32_t face = 0; face < groups.size(); ++face) groups[face] = place[exclusion_.patch_of(face)];
}

std::unique_ptr<map::FaceSearch> SelfMeasure::search() const {
  return std::make_unique<FaceSelfSearch>(sites_, exclusion_, patches_, max_distance_);
}

bool SelfMeasure::counts_at_vertices(std::uint32_t face) const {
  return !sites_.topology.ignored(face);
}

}  // namespace sdm::self
