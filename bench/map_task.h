// A map computed by sdm and by Embree.
#pragma once

#include <sdm/map.h>

#include <memory>
#include <span>
#include <vector>

#include "embree_map.h"
#include "engine/cpu/descent.h"

namespace sdm::bench {

/// The unsigned map of O1 to O2. Both fill in the same texels in the same order, each into memory that it has
/// already.
class MapTask {
 public:
  MapTask(std::shared_ptr<Surface> o1, const Mesh& o2);

  void compute();
  void ask_embree();

  /// Moves the vertices: ours are refitted; Embree is given the new texels, and its tree is built anew.
  void refit(std::span<const Vec3> o1, std::span<const Vec3> o2);

  /// Computes both maps and returns whether they agree at every texel to 1e-6 of the diagonal of both meshes'
  /// box. Says on stderr where they do not.
  [[nodiscard]] bool agrees();

  [[nodiscard]] std::size_t texels() const { return queries_.size(); }
  [[nodiscard]] cpu::DescentCounts work() const {
    return cpu::count_work(internals(sites_), surface_->sample_points());
  }
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

}  // namespace sdm::bench
