/// Engines: the algorithms that find closest points.
///
/// Threads: all functions may be called concurrently; an engine may serve several threads at once.
#pragma once

#include <sdm/types.h>

#include <memory>
#include <span>
#include <string_view>

namespace sdm {

/// An engine with its options: opaque, passed in MapOptions::engine. Several threads may use it concurrently.
class Engine;

/// What there is to know about an engine before it is made.
struct EngineInfo {
  std::string_view name;
  std::string_view summary;
  /// Upper bound on the error of a distance, including the rounding to float, as a fraction of the diagonal
  /// of the bounding box of both meshes.
  double relative_error = 0;
  bool takes_points = true;  ///< closest_points() can use it, not only compute_map()
};

/// All engines, the default one (cpu) first.
[[nodiscard]] SDM_API std::span<const EngineInfo> engines();

/// Returns the engine of this name with its default options. Throws sdm::Error for an unknown name, or for an
/// engine that this build does not contain.
[[nodiscard]] SDM_API std::shared_ptr<const Engine> make_engine(std::string_view name);

/// Returns the entry of engines() for this engine.
[[nodiscard]] SDM_API const EngineInfo& engine_info(const Engine& engine);

}  // namespace sdm
