/// The gpu engine: closest points by compute shaders, on Vulkan, Metal or D3D12: options and report; and maps
/// that stay on a device.
///
/// Threads: all functions may be called concurrently; an engine may serve several threads at once, and a
/// GpuMap is used by one at a time.
#pragma once

#include <sdm/engine.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/types.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

/// A device that runs compute shaders.
struct GpuDevice {
  std::string name;    ///< as its driver has it
  std::string driver;  ///< the driver's own words, such as its version
  bool software = false;
};

template <>
inline constexpr std::tuple kFields<GpuDevice>{
    Field{"name", &GpuDevice::name, "The device's name, as its driver has it."},
    Field{"driver", &GpuDevice::driver, "The driver's own words, such as its version."},
    Field{"software", &GpuDevice::software, "Whether it computes on the processor."}};

/// All devices that can run the gpu engine, in order of preference: hardware first. Throws sdm::Error if
/// there is none, if the library of wgpu-native is missing, or if sdm was built without it (SDM_BUILD_GPU).
[[nodiscard]] SDM_API std::vector<GpuDevice> gpu_devices();

/// Options of make_gpu_engine().
struct GpuOptions {
  /// Index into gpu_devices(), or a part of a name in it (case-insensitive); empty selects the first device.
  std::string device{};
};

template <>
inline constexpr auto kOptions<GpuOptions> =
    std::tuple{Option{.name = "device",
                      .member = &GpuOptions::device,
                      .text = "The device, by its number in `sdm devices` or part of its name.",
                      .value = "NAME"}};

/// What a gpu engine did since it was made.
struct GpuReport {
  std::string device;
  std::string results = "read back (double)";  ///< where they are from, and their precision
  std::uint64_t points = 0;                    ///< that closest points were searched for
  std::uint64_t nodes = 0;                     ///< of the tree, visited on the device
  std::uint64_t tests = 0;                     ///< of a point and a face on the device
  std::uint64_t candidates = 0;                ///< faces compared in double precision
  /// Points with more candidates than there is room for, which are searched for in double precision.
  std::uint64_t incomplete = 0;
  std::uint64_t alone = 0;  ///< points that were not searched for with those beside them
  std::uint64_t dispatches = 0;
  double upload_ms = 0, search_ms = 0, finish_ms = 0;  ///< wall-clock; finish: of all threads
};

template <>
inline constexpr std::tuple kFields<GpuReport>{
    Field{"device", &GpuReport::device, "The device's name."},
    Field{"results", &GpuReport::results, "Where the results are from, and their precision."},
    Field{"points", &GpuReport::points, "Points that closest points were searched for."},
    Field{"nodes", &GpuReport::nodes, "Nodes of the tree, visited on the device."},
    Field{"tests", &GpuReport::tests, "Tests of a point and a face on the device."},
    Field{"candidates", &GpuReport::candidates, "Faces that were compared in double precision."},
    Field{"incomplete", &GpuReport::incomplete,
          "Points with more candidates than there is room for, searched for in double precision."},
    Field{"alone", &GpuReport::alone, "Points that were not searched for with those beside them."},
    Field{"dispatches", &GpuReport::dispatches, "Runs of the shaders."},
    Field{"upload_ms", &GpuReport::upload_ms, "Milliseconds of copies to the device."},
    Field{"search_ms", &GpuReport::search_ms, "Milliseconds of the search, and of copies from the device."},
    Field{"finish_ms", &GpuReport::finish_ms,
          "Milliseconds of the comparison in double precision, of all threads."}};

/// Returns a gpu engine with these options. Throws sdm::Error as gpu_devices() does, and if there is no such
/// device.
[[nodiscard]] SDM_API std::shared_ptr<const Engine> make_gpu_engine(const GpuOptions& options = {});

/// Returns the report of a gpu engine; empty for any other engine.
[[nodiscard]] SDM_API std::optional<GpuReport> gpu_report(const Engine& engine);

/// What the distances of a GpuMap are summed up to.
struct GpuMapStatistics {
  std::uint64_t samples = 0;
  double smallest = 0, largest = 0, mean = 0, rms = 0;
  std::uint64_t largest_at = 0;  ///< the first sample with the largest distance on the device
  double error = 0;              ///< that smallest, largest, mean and rms have at most
  std::uint64_t within = 0, beyond = 0;
  std::string results{};  ///< "device (single precision, ± 2.1e-06)": where they are from, and `error`
};

template <>
inline constexpr std::tuple kFields<GpuMapStatistics>{
    Field{"samples", &GpuMapStatistics::samples, "The samples of the surface."},
    Field{"smallest", &GpuMapStatistics::smallest, "The smallest distance."},
    Field{"largest", &GpuMapStatistics::largest, "The largest distance."},
    Field{"mean", &GpuMapStatistics::mean, "The mean of the distances."},
    Field{"rms", &GpuMapStatistics::rms, "The root of the mean of their squares."},
    Field{"largest_at", &GpuMapStatistics::largest_at,
          "The first sample with the largest distance on the device."},
    Field{"error", &GpuMapStatistics::error,
          "The error that the smallest, the largest, the mean and the rms distance have at most."},
    Field{"within", &GpuMapStatistics::within, "Samples that are certainly within the tolerance."},
    Field{"beyond", &GpuMapStatistics::beyond,
          "Samples that are certainly beyond it. All others are nearer to it than their error."},
    Field{"results", &GpuMapStatistics::results, "Where the numbers are from, and their precision."}};

/// Options of a GpuMap.
struct GpuMapOptions {
  std::string device{};  ///< as GpuOptions::device
  bool closest = false;  ///< whether the map has closest points, too: 24 bytes for each sample on the device
};

/// The closest points of the samples of a GpuMap, as they are on the device.
struct GpuMapClosest {
  std::vector<Vec3f> vector;        ///< closest point of O2 − sample
  std::vector<SiteType> site_type;  ///< of the site that it lies on
  std::vector<std::uint32_t> site;  ///< index among those of its type
  std::vector<std::uint32_t> face;  ///< that the site belongs to
};

/// A map in single precision that stays on a device: of each sample of a surface the distance, unsigned, and,
/// if wanted, the closest point. Only what is asked for is read back. Each has a proven error
/// (docs/design/gpu.md); for results to the last bit, compute a map by the gpu engine.
class SDM_API GpuMap {
 public:
  /// Opens a device of its own, and computes the map. Throws sdm::Error as make_gpu_engine() does, and as
  /// compute() does.
  GpuMap(const Surface& surface, const Sites& sites, const GpuMapOptions& options = {});
  ~GpuMap();
  GpuMap(GpuMap&&) noexcept;
  GpuMap& operator=(GpuMap&&) noexcept;

  /// Computes the map anew, of any surface. Throws sdm::Error if the device fails, has no memory left, or if
  /// the surface reaches too far from O2 for single precision, by more than 7 times its size; Cancelled.
  /// There is no map afterwards then.
  void compute(const Surface& surface, const Sites& sites);
  /// The next frame: the same for the last surface with its vertices at these positions, of which
  /// Surface::refit() does not know. Only vertices are uploaded, and of O2 if it has changed: its vertices
  /// after Sites::refit(), all of it otherwise. Throws also if their number is not that of its mesh.
  void compute(std::span<const Vec3> positions, const Sites& sites);
  /// The same for the last O2 with its vertices at these positions, of which its Sites need not know: its
  /// tree is refitted on the device. Throws also if one of its faces is not finite.
  void compute(std::span<const Vec3> positions, std::span<const Vec3> positions_o2);

  /// The number of samples: those of Surface::sample_texels().
  [[nodiscard]] std::size_t samples() const;
  /// The error that a distance has at most which is this one on the device. A closest point lies within this
  /// of its site, and the length of its vector is within four times this of the distance to O2.
  [[nodiscard]] double error(double distance) const;
  /// Sums the distances up on the device, and counts those within `tolerance` and beyond it. Throws
  /// sdm::Error if there is no map or the device fails.
  [[nodiscard]] GpuMapStatistics statistics(double tolerance = 0) const;
  /// Reads the distances back, in the order of Surface::sample_texels(). Throws as statistics() does.
  [[nodiscard]] std::vector<float> distances() const;
  /// Reads the closest points back, in the same order. Where several faces are as close as another within the
  /// errors, it is that of any of them. Throws as statistics() does, and if the map has none.
  [[nodiscard]] GpuMapClosest closest() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm
