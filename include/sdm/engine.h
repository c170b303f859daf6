/// The engines, which find closest points.
#pragma once

#include <sdm/api.h>

#include <memory>
#include <span>
#include <string_view>

namespace sdm {

/// An engine with its options. Opaque; pass it in MapOptions::engine. Any number of threads may use it at the
/// same time.
class Engine;

struct EngineInfo {
  std::string_view name;
  std::string_view summary;
  /// A bound on the error of a distance, rounding to float included, relative to the diagonal of the bounding
  /// box of both meshes.
  double relative_error = 0;
  bool maps_only = false;  ///< compute_map() can use it, closest_points() cannot
};

/// All engines, the default one (cpu) first.
[[nodiscard]] SDM_API std::span<const EngineInfo> engines();

/// The engine of this name, with its default options. Throws sdm::Error for an unknown name, or for an engine
/// that this build does not contain.
[[nodiscard]] SDM_API std::shared_ptr<const Engine> make_engine(std::string_view name);

/// The row of engines() for this engine.
[[nodiscard]] SDM_API const EngineInfo& engine_info(const Engine& engine);

}  // namespace sdm
