// Distances to the closest point of O2, or of the faces that face the samples: what is made of the closest
// points that engines find.
#pragma once

#include <sdm/closest_points.h>
#include <sdm/map.h>

#include <memory>
#include <optional>

#include "closest/engine.h"
#include "inside/inside.h"
#include "map/facing_measure.h"
#include "map/measure.h"

namespace sdm::map {

/// Returns the engine of the options. Throws sdm::Error for options out of their ranges.
template <class Options>
[[nodiscard]] std::shared_ptr<const Engine> engine_of(const Options& options) {
  check_options(options);
  return options.engine ? options.engine : make_engine(engines().front().name);
}

/// Returns what a search for closest points has of the options of a map.
[[nodiscard]] inline ClosestPointOptions point_options(const MapOptions& options) {
  return {.engine = options.engine, .max_distance = options.max_distance, .progress = options.progress};
}

class ClosestMeasure {
 public:
  /// All must outlive this. Throws sdm::Error for options that do not apply.
  ClosestMeasure(const Surface& surface, const Sites& sites, const MapOptions& options);

  [[nodiscard]] const Engine& engine() const { return *engine_; }
  [[nodiscard]] const Description& description() const {
    return facing_ ? facing_->description : description_;
  }

  /// Stores what follows from the closest points of the samples from the one with this number on.
  void store(std::size_t first, std::span<const Vec3> points, const sites::ClosestPacket& closest,
             TexelStore& texels) const;

 private:
  void store_matches(std::size_t first, std::span<const Vec3> points, const sites::ClosestPacket& closest,
                     TexelStore& texels) const;

  const Surface& surface_;
  std::shared_ptr<const Engine> engine_;
  std::optional<FacingMeasure> facing_;
  // Without it:
  Description description_;
  std::optional<inside::InsideTest> inside_;
};

}  // namespace sdm::map
