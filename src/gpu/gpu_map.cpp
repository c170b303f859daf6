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
#include "gpu/packed_sites.h"
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

  void set_samples(const Surface& surface);
  void compute(std::span<const Vec3> at, const Sites& sites);
  [[nodiscard]] std::size_t size_of(std::size_t part) const {
    return std::min(gpu::kPart, count - gpu::kPart * part);
  }
  // Throws sdm::Error if there are no samples, or no distances.
  static void require(std::size_t present) {
    if (present == 0) throw Error("there is no map on the device: computing it has failed");
  }

  gpu::FaceSearch search;
  gpu::Pipeline sum;
  gpu::Buffer limits, sums, read_back, positions;
  struct Part {
    gpu::Buffer samples, distances;  // these in the unit frame
  };
  std::vector<Part> parts;
  std::vector<std::uint8_t> used;  // whether a vertex belongs to the face of a sample
  std::size_t samples = 0;         // that the parts have
  std::size_t count = 0;           // the same if they have distances, or 0
  double scale = 1;                // of the unit frame
  gpu::DistanceError error{};
};

void GpuMap::Impl::set_samples(const Surface& surface) {
  using Use = gpu::Device::Use;
  gpu::Device& device = search.device();
  const surface::SurfaceData& o1 = internals(surface);
  count = samples = 0;
  sums.reset();
  read_back.reset();
  positions.reset();
  parts.clear();
  sums = device.buffer(gpu::kPart / gpu::kSummed * sizeof(gpu::Sums), Use::write, "statistics");
  read_back = device.buffer(gpu::kPart * sizeof(float), Use::read_back, "distances");
  positions = device.buffer(3 * sizeof(float) * o1.mesh.positions.size(), Use::read, "the vertices of O1");
  used.assign(o1.mesh.positions.size(), 0);
  std::vector<gpu::Sample> of_part;
  for (std::size_t begin = 0; begin < o1.samples.size(); begin += gpu::kPart) {
    of_part.resize(std::min(gpu::kPart, o1.samples.size() - begin));
    parallel_for(of_part.size(), 4096, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const std::uint32_t face = o1.sample_faces[begin + i];
        const auto& [a, b, c] = o1.mesh.triangles[face];
        const Vec2 weights = o1.texel_weights(face, o1.samples[begin + i]);
        of_part[i] = {{a, b, c}, {static_cast<float>(weights[0]), static_cast<float>(weights[1])}};
      }
    });
    for (const gpu::Sample& sample : of_part)
      for (const std::uint32_t vertex : sample.vertices) used[vertex] = 1;
    parts.push_back({.samples = device.buffer(of_part.size() * sizeof(gpu::Sample), Use::read, "samples"),
                     .distances = device.buffer(of_part.size() * sizeof(float), Use::write, "distances")});
    device.write(parts.back().samples, std::as_bytes(std::span(of_part)));
  }
  samples = o1.samples.size();
}

void GpuMap::Impl::compute(std::span<const Vec3> at, const Sites& sites) {
  const sites::SitesData& o2 = internals(sites);
  count = 0;
  require(samples);
  if (at.size() != used.size())
    throw Error("the map on the device has " + std::to_string(used.size()) + " vertices, not " +
                std::to_string(at.size()));
  std::vector<float> placed(3 * at.size());
  double outermost = 1;
  for (std::size_t v = 0; v < at.size(); ++v) {
    if (used[v] == 0) continue;
    const Vec3 unit = o2.frame.to_unit(at[v]);
    for (int k = 0; k < 3; ++k) {
      if (!(std::abs(unit[k]) <= gpu::kFar))
        throw Error(
            "O1 reaches too far from O2 for a map on the device, by more than 7 times its size: use an "
            "engine");
      outermost = std::max(outermost, std::abs(unit[k]));
      placed[3 * v + k] = static_cast<float>(unit[k]);
    }
  }
  search.device().write(positions, std::as_bytes(std::span(placed)));
  for (std::size_t part = 0; part < parts.size(); ++part)
    search.measure(o2, {parts[part].samples, positions}, std::min(gpu::kPart, samples - gpu::kPart * part),
                   parts[part].distances);
  error = gpu::sample_error(o2, outermost);
  scale = o2.frame.scale;
  count = samples;
}

GpuMap::GpuMap(const Surface& surface, const Sites& sites, const GpuOptions& options)
    : impl_(std::make_unique<Impl>(options)) {
  compute(surface, sites);
}
GpuMap::~GpuMap() = default;
GpuMap::GpuMap(GpuMap&&) noexcept = default;
GpuMap& GpuMap::operator=(GpuMap&&) noexcept = default;

void GpuMap::compute(const Surface& surface, const Sites& sites) {
  impl_->set_samples(surface);
  impl_->compute(surface.mesh().positions, sites);
}

void GpuMap::compute(std::span<const Vec3> positions, const Sites& sites) {
  impl_->compute(positions, sites);
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
  map.require(map.count);
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
    const gpu::Device::Binding bindings[] = {
        {0, &map.limits}, {1, &map.parts[part].distances}, {2, &map.sums}};
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
  map.require(map.count);
  require_memory(map.count * sizeof(float), "the distances of a map");
  std::vector<float> all(map.count);
  for (std::size_t part = 0; part < map.parts.size(); ++part) {
    const std::span<float> of_part = std::span(all).subspan(gpu::kPart * part, map.size_of(part));
    map.search.device().run({}, map.parts[part].distances, map.read_back, std::as_writable_bytes(of_part));
  }
  const auto inverse = static_cast<float>(1 / map.scale);  // a power of two
  for (float& distance : all) distance *= inverse;
  return all;
}

}  // namespace sdm
