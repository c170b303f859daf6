// Maps whose distances stay on a device (sdm/gpu.h).
#include <sdm/error.h>
#include <sdm/gpu.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "gpu/face_search.h"
#include "gpu/finish.h"
#include "gpu/shaders.h"
#include "sites/sites_data.h"
#include "surface/surface_data.h"

namespace sdm {
namespace gpu {
namespace {

// As in shaders/map_statistics.wgsl.
struct Limits {
  std::uint32_t count;
  float within, beyond;
  std::uint32_t padding;
};
struct Sums {
  float smallest, largest, sum, squares;
  std::uint32_t largest_at, within, beyond, padding;
};
static_assert(sizeof(Limits) == 16 && sizeof(Sums) == 32);
constexpr std::size_t kSummed = 1024;  // distances

// A part of the map has a buffer of its own, which every device permits.
constexpr std::size_t kPart = 1 << 20;  // samples

// Relative to the largest distance: 12 sums follow each other, of which each is off by 2⁻²³ of itself.
constexpr double kSumError = 2e-6;

// The nearest numbers in single precision that are not above, or not below.
float not_above(double x) {
  constexpr double kRange = std::numeric_limits<float>::max();
  const auto rounded = static_cast<float>(std::clamp(x, -kRange, kRange));
  return rounded > x ? std::nextafter(rounded, -std::numeric_limits<float>::infinity()) : rounded;
}
float not_below(double x) {
  return -not_above(-x);
}

}  // namespace
}  // namespace gpu

struct GpuMap::Impl {
  explicit Impl(const GpuOptions& options)
      : search(options.device),
        sum(search.device().pipeline(gpu::kMapStatisticsWgsl.bytes)),
        limits(search.device().buffer(sizeof(gpu::Limits), gpu::Device::Use::uniform, "constants")) {}

  void compute(const Surface& surface, const Sites& sites);
  void reserve(std::size_t count);
  [[nodiscard]] std::size_t size_of(std::size_t part) const {
    return std::min(gpu::kPart, count - gpu::kPart * part);
  }
  void require_map() const {
    if (count == 0) throw Error("there is no map on the device: computing it has failed");
  }

  gpu::FaceSearch search;
  gpu::Pipeline sum;
  gpu::Buffer limits, sums, read_back;
  std::vector<gpu::Buffer> parts;  // distances in the unit frame
  std::size_t count = 0;
  double scale = 1;  // of the unit frame
  gpu::DistanceError error{};
};

void GpuMap::Impl::reserve(std::size_t samples) {
  using Use = gpu::Device::Use;
  gpu::Device& device = search.device();
  if (parts.empty()) {
    sums = device.buffer(gpu::kPart / gpu::kSummed * sizeof(gpu::Sums), Use::write, "statistics");
    read_back = device.buffer(gpu::kPart * sizeof(float), Use::read_back, "distances");
  }
  const std::size_t needed = (samples + gpu::kPart - 1) / gpu::kPart;
  parts.resize(std::min(parts.size(), needed));
  while (parts.size() < needed)
    parts.push_back(device.buffer(gpu::kPart * sizeof(float), Use::write, "distances"));
}

void GpuMap::Impl::compute(const Surface& surface, const Sites& sites) {
  const sites::SitesData& o2 = internals(sites);
  const surface::SurfaceData& o1 = internals(surface);
  const std::size_t samples = surface.sample_texels().size();
  count = 0;
  reserve(samples);
  double outermost = 1;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const std::size_t begin = gpu::kPart * part, size = std::min(gpu::kPart, samples - begin);
    constexpr std::size_t kTile = gpu::FaceSearch::kTile;
    // What fills the last tile is skipped.
    std::vector<gpu::QueryPoint> placed((size + kTile - 1) / kTile * kTile, {{}, -1});
    parallel_for(size, 4096, [&](std::size_t first, std::size_t last) {
      std::vector<Vec3> points(last - first);
      o1.place_samples(begin + first, points);
      gpu::place_points(o2, points, kInfinity, std::span(placed).subspan(first, points.size()));
    });
    for (const gpu::QueryPoint& point : std::span(placed).first(size)) {
      if (point.within < 0)
        throw Error(
            "a sample is too far from O2 for a map on the device, by more than 7 times its size: use an "
            "engine");
      for (const float x : point.position) outermost = std::max<double>(outermost, std::abs(x));
    }
    search.measure(o2, placed, size, parts[part], 0);
  }
  error = gpu::distance_error(o2, outermost);
  scale = o2.frame.scale;
  count = samples;
}

GpuMap::GpuMap(const Surface& surface, const Sites& sites, const GpuOptions& options)
    : impl_(std::make_unique<Impl>(options)) {
  impl_->compute(surface, sites);
}
GpuMap::~GpuMap() = default;
GpuMap::GpuMap(GpuMap&&) noexcept = default;
GpuMap& GpuMap::operator=(GpuMap&&) noexcept = default;

void GpuMap::compute(const Surface& surface, const Sites& sites) {
  impl_->compute(surface, sites);
}

std::size_t GpuMap::samples() const {
  return impl_->count;
}

double GpuMap::error(double distance) const {
  return impl_->error.each * distance + impl_->error.constant / impl_->scale;
}

GpuMapStatistics GpuMap::statistics(double tolerance) const {
  if (!(tolerance >= 0)) throw Error("the tolerance of a map must be a number that is not negative");
  Impl& map = *impl_;
  map.require_map();
  gpu::Device& device = map.search.device();
  const double unit_tolerance = tolerance * map.scale;
  const auto& [each, constant] = map.error;
  GpuMapStatistics all{.samples = map.count, .smallest = kInfinity, .largest = -1};
  double sum = 0, squares = 0;
  std::vector<gpu::Sums> sums;
  for (std::size_t part = 0; part < map.parts.size(); ++part) {
    const std::size_t size = map.size_of(part);
    sums.resize((size + gpu::kSummed - 1) / gpu::kSummed);
    const gpu::Limits limits{.count = static_cast<std::uint32_t>(size),
                             .within = gpu::not_above((unit_tolerance - constant) / (1 + each)),
                             .beyond = gpu::not_below((unit_tolerance + constant) / (1 - each)),
                             .padding = 0};
    device.write(map.limits, std::as_bytes(std::span(&limits, 1)));
    const gpu::Device::Binding bindings[] = {{0, &map.limits}, {1, &map.parts[part]}, {2, &map.sums}};
    const gpu::BindGroup group = device.bind(map.sum, bindings);
    const gpu::Device::Step steps[] = {{&map.sum, &group, static_cast<std::uint32_t>(sums.size())}};
    device.run(steps, map.sums, map.read_back, std::as_writable_bytes(std::span(sums)));
    for (const gpu::Sums& each_sum : sums) {
      if (each_sum.largest > all.largest) {
        all.largest = each_sum.largest;
        all.largest_at = gpu::kPart * part + each_sum.largest_at;
      }
      all.smallest = std::min<double>(all.smallest, each_sum.smallest);
      sum += each_sum.sum;
      squares += each_sum.squares;
      all.within += each_sum.within;
      all.beyond += each_sum.beyond;
    }
  }
  const auto samples = static_cast<double>(map.count);
  all.mean = sum / samples / map.scale;
  all.rms = std::sqrt(squares / samples) / map.scale;
  all.smallest /= map.scale;
  all.largest /= map.scale;
  all.error = error(all.largest) + gpu::kSumError * all.largest;
  return all;
}

std::vector<float> GpuMap::distances() const {
  Impl& map = *impl_;
  map.require_map();
  require_memory(map.count * sizeof(float), "the distances of a map");
  std::vector<float> all(map.count);
  for (std::size_t part = 0; part < map.parts.size(); ++part) {
    const std::span<float> of_part = std::span(all).subspan(gpu::kPart * part, map.size_of(part));
    map.search.device().run({}, map.parts[part], map.read_back, std::as_writable_bytes(of_part));
  }
  const auto inverse = static_cast<float>(1 / map.scale);  // a power of two
  for (float& distance : all) distance *= inverse;
  return all;
}

}  // namespace sdm
