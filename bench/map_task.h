// A map that both the cpu engine and Embree compute.
#pragma once

#include <sdm/map.h>

#include <memory>
#include <span>
#include <vector>

#include "embree_map.h"
#include "timing.h"

namespace sdm::bench {

/// The unsigned map of O1 to O2. Both compute the same texels in the same order, and write to memory that is
/// already allocated.
class MapTask {
 public:
  MapTask(std::shared_ptr<Surface> o1, const Mesh& o2);

  void compute();
  void compute_with_embree();

  /// Moves the vertices: refits the surface and the sites, and rebuilds Embree's scene.
  void refit(std::span<const Vec3> o1, std::span<const Vec3> o2);

  /// Computes both maps. Returns whether they agree at every texel, to 1e-6 of the diagonal of the bounding
  /// box of both meshes; prints the number of texels that do not to stderr.
  [[nodiscard]] bool agrees();

  [[nodiscard]] std::size_t texels() const { return queries_.size(); }
  [[nodiscard]] Surface& surface() { return *surface_; }
  [[nodiscard]] Sites& sites() { return sites_; }

 private:
  void place_queries();

  std::shared_ptr<Surface> surface_;
  Sites sites_;
  DistanceMap map_;
  std::unique_ptr<EmbreeScene> embree_;
  std::vector<EmbreeTexel> queries_;
};

/// Maps that are measured together, one after another.
using Tasks = std::vector<MapTask*>;

[[nodiscard]] bool all_agree(const Tasks& tasks);
[[nodiscard]] Contender ours(const Tasks& tasks, unsigned threads);
[[nodiscard]] Contender embree(const Tasks& tasks, unsigned threads);

/// "texels"; in builds with work counters, also the engine's counts per packet of sixteen texels.
[[nodiscard]] std::vector<Figure> work_figures(const Tasks& tasks);

}  // namespace sdm::bench
