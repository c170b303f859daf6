// The gpu engine: a search of the tree by compute shaders in WGSL, finished in double precision on the
// processor.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "closest/engine.h"

namespace sdm::gpu {

inline constexpr EngineInfo kInfo{
    .name = "gpu", .summary = "a search by compute shaders", .relative_error = 1e-6};

struct GpuOptions {
  std::string device;  ///< a part of its name, or empty: the first one that is no processor, or the first one
};

/// What an engine did since it was made.
struct GpuReport {
  std::string device;
  std::size_t points = 0;
  std::size_t nodes = 0;       ///< visited on the device
  std::size_t tests = 0;       ///< of a point and a face on the device
  std::size_t candidates = 0;  ///< compared in double precision
  std::size_t incomplete =
      0;  ///< points with more candidates than there is room for, which are searched for in double
  std::size_t alone = 0;  ///< points that were not searched for with those beside them
  std::size_t dispatches = 0;
  double upload_ms = 0, search_ms = 0, finish_ms = 0;  ///< finish: of all threads
};

/// Throws sdm::Error if there is no wgpu-native, or no such device; or if this build does not contain the
/// engine.
[[nodiscard]] std::shared_ptr<const Engine> make_gpu_engine(const GpuOptions& options);

/// The report of a gpu engine.
[[nodiscard]] std::optional<GpuReport> gpu_report(const Engine& engine);

}  // namespace sdm::gpu
