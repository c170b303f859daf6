// The loops over texels, vertices and points, which all measures share.
#pragma once

#include <sdm/closest_points.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/surface.h>

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "map/map_writer.h"
#include "sites/closest_packet.h"

namespace sdm::map {

/// What is stored of every measure.
struct Description {
  MeasuredDistance measured{};
  SignUsed sign{};
  NoValue no_value{};
};

/// Stores packets of values in a map, from several threads, and counts the texels without one.
class TexelStore {
 public:
  /// Clears the map. `texels`: those that are measured, in any order. All but the description must outlive
  /// this.
  TexelStore(DistanceMap& map, const Surface& surface, const Description& description,
             std::span<const std::uint32_t> texels);
  /// The same of a range of the texels: the others keep their values.
  TexelStore(DistanceMap& map, const Description& description, std::span<const std::uint32_t> texels,
             const SampleRange& range);

  /// Stores the values of the texels from the one with this number on; their bits are set in `negative` if
  /// the distance is negative, and in `unmatched` if nothing is allowed at any distance: these have no value.
  void operator()(std::size_t first, const sites::ClosestPacket& values, std::uint32_t negative,
                  std::uint32_t unmatched = 0);
  /// Stores the counts in the map.
  void finish();

 private:
  // Indexed by the samples' position, so that threads rarely write to the same cache line.
  struct alignas(64) Counter {
    std::atomic<std::size_t> without{0}, unmatched{0};
  };

  DistanceMap& map_;
  std::span<const std::uint32_t> texels_;
  MapWriter writer_;
  std::array<Counter, 64> counters_;
};

/// A point to measure from.
struct Sample {
  Vec3 point{};
  std::uint32_t face = kNone;             ///< of O1, that it is on; kNone: a point of none
  std::optional<Vec3> normal{};           ///< if the measure asks for it
  const ClosestPoint* closest = nullptr;  ///< that of FaceMeasure::closest, if there is one
};

/// What is found for one sample.
struct Value {
  ClosestPoint closest{};  ///< type none: no value
  Vec3 vector{};           ///< closest point − sample
  bool negative = false;
  bool unmatched = false;  ///< there is nothing to measure to, at any distance
};

/// Measures from one block of samples after another. At most one per thread at a time.
class FaceSearch {
 public:
  FaceSearch() = default;
  virtual ~FaceSearch() = default;
  FaceSearch(const FaceSearch&) = delete;
  FaceSearch& operator=(const FaceSearch&) = delete;

  /// Begins with these samples, which must outlive the calls of value(). It costs less if samples that follow
  /// each other are near each other.
  virtual void start(std::span<const Sample> samples) = 0;
  /// The value of each of these samples, in their order.
  virtual Value value(std::size_t sample) = 0;
};

/// A measure of samples by their faces, which an engine's closest points of O2 may precede.
class FaceMeasure {
 public:
  FaceMeasure() = default;
  virtual ~FaceMeasure() = default;
  FaceMeasure(const FaceMeasure&) = delete;
  FaceMeasure& operator=(const FaceMeasure&) = delete;

  [[nodiscard]] virtual std::unique_ptr<FaceSearch> search() const = 0;
  /// Whether a face that is not removed has values at its vertices.
  [[nodiscard]] virtual bool counts_at_vertices(std::uint32_t) const { return true; }

  Description description;
  Progress progress;
  std::vector<Vec3> normals;  ///< of the faces, if they decide
  /// The closest point of O2 of each of the vertices or points, if the measure begins with them.
  std::vector<ClosestPoint> closest;
  /// The group of each face. Faces of a group measure alike from a point that they share; groups are measured
  /// in their order. Empty: each face is a group.
  std::vector<std::uint32_t> groups;
};

/// Computes the map of a measure. Throws Cancelled.
void measure_texels(const Surface& surface, const FaceMeasure& measure, DistanceMap& map);
/// The same of some samples, as compute_samples() in sdm/map.h.
void measure_texels(const Surface& surface, const FaceMeasure& measure, const SampleRange& range,
                    DistanceMap& map);
/// Throws sdm::Error unless the map is one of the surface, and the range one for compute_samples().
void check_part(const Surface& surface, const SampleRange& range, const DistanceMap& map);

/// Returns, for each vertex, the value of least absolute value that its faces have there, of the first face
/// that has it; NaN for a vertex without one, or what is without a value. Throws Cancelled.
[[nodiscard]] std::vector<float> measure_vertices(const Mesh& mesh, const FaceMeasure& measure);

/// Measures from points, with normals or without. Throws Cancelled.
[[nodiscard]] FacingPoints measure_points(std::span<const Vec3> points, std::span<const Vec3> normals,
                                          const FaceMeasure& measure);

}  // namespace sdm::map
