// The interface of all engines: finds the closest site of each sample of a surface, or of any points.
#pragma once

#include <sdm/engine.h>
#include <sdm/execution.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <functional>
#include <span>

#include "sites/closest_packet.h"

namespace sdm {
namespace engine {

/// Receives the closest points of the samples from index `first` on; `points` are the samples' positions.
using SampleSink =
    std::function<void(std::size_t first, std::span<const Vec3> points, const sites::ClosestPacket& closest)>;

struct EngineOptions {
  double max_distance = kInfinity;  ///< > 0
  Progress progress{};
};

}  // namespace engine

class Engine {
 public:
  Engine() = default;
  virtual ~Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  [[nodiscard]] virtual const EngineInfo& info() const = 0;

  /// Passes the closest point of every sample to the sink exactly once, from several threads concurrently;
  /// type `none` where nothing is within max_distance. Calls closest_points for blocks of samples, unless
  /// overridden. Throws sdm::Error if the engine fails; Cancelled.
  virtual void map(const Surface& surface, const Sites& sites, const engine::EngineOptions& options,
                   const engine::SampleSink& sink) const;

  /// Passes the closest point of every point to the sink, in order and on the calling thread. Called for
  /// blocks of neighbouring points (see closest/blocks.h) from several threads. Throws sdm::Error if
  /// the engine computes maps only.
  virtual void closest_points(const Sites& sites, std::span<const Vec3> points, double max_distance,
                              const sites::ClosestSink& sink) const = 0;

  /// Sets found[i] to the closest point of points[i], which are in any order, with a face of its site. On all
  /// cores. Calls closest_points for blocks of the points in a spatial order, unless overridden. Throws as
  /// closest_points does; Cancelled.
  virtual void scattered(const Sites& sites, std::span<const Vec3> points,
                         const engine::EngineOptions& options, std::span<ClosestPoint> found) const;
};

}  // namespace sdm
