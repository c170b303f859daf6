#include <sdm/bake.h>
#include <sdm/error.h>
#include <sdm/types.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "baking/geometry/texel_walk.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "map/transfer/corner_normals.h"

namespace sdm {
namespace {

/// Checks the grid; returns the number of rows of texels.
std::size_t texel_rows(const SampleGrid& grid, std::size_t components, std::size_t numbers) {
  const std::size_t of_row = std::size_t{grid.resolution} * grid.side * components;  // of texels
  if (of_row == 0 || grid.resolution % grid.side != 0 || numbers % of_row != 0)
    throw Error("samples of texels must be whole rows of squares of " + std::to_string(grid.side) +
                " samples a side");
  return numbers / of_row;
}

/// Calls body(texel, first, memory) for each texel and its first sample; `memory` begins as a copy of `empty`
/// and remains from texel to texel.
template <class Memory, class Body>
void for_each_square(const SampleGrid& grid, std::size_t rows, const Memory& empty, const Body& body) {
  parallel_for(rows, 8, [&](std::size_t begin, std::size_t end) {
    const std::size_t width = grid.texels();
    Memory memory = empty;
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < width; ++x)
        body(y * width + x, y * grid.side * grid.resolution + x * grid.side, memory);
  });
}

/// Sums of the samples of a texel that have values.
class Sum {
 public:
  explicit Sum(std::size_t components) : sums_(components) {}

  void clear() {
    std::ranges::fill(sums_, 0);
    count_ = 0;
  }
  void add(const float* sample) {
    if (!std::all_of(sample, sample + sums_.size(), [](float x) { return std::isfinite(x); })) return;
    if (count_++ == 0) first_ = sample;
    for (std::size_t k = 0; k < sums_.size(); ++k) sums_[k] += sample[k];
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  void store(SampleKind kind, float* to) const {
    double divisor = static_cast<double>(count_);
    if (kind == SampleKind::directions) {
      divisor = 0;
      for (const double x : sums_) divisor += x * x;
      divisor = std::sqrt(divisor);
    }
    constexpr double kLeast = 1e-6;  // of the length of unit vectors that do not cancel out
    for (std::size_t k = 0; k < sums_.size(); ++k)
      to[k] = divisor > kLeast ? static_cast<float>(sums_[k] / divisor) : first_[k];
  }

 private:
  std::vector<double> sums_;
  std::size_t count_ = 0;
  const float* first_ = nullptr;
};

/// Which samples of a texel belong together.
class Sides {
 public:
  Sides(const Surface& surface, const MeshAttribute* normals) : surface_(surface) {
    if (normals != nullptr) normals_.emplace(surface.mesh(), *normals, "the surface");
  }

  /// What decides with what a place of a face belongs.
  struct Place {
    std::uint32_t chart;
    Vec3 normal;
  };
  /// What was found of a texel; each thread needs its own.
  struct Memory {
    baking::TexelPlaces places;
    std::vector<std::uint32_t> samples;
    std::vector<Place> of_samples{};
  };
  [[nodiscard]] Memory memory() const { return {baking::TexelPlaces(internals(surface_)), {}}; }

  /// Removes the samples that do not belong with the face at the centre of the texel.
  void keep_one(const Vec2& centre, Memory& memory) const {
    std::vector<std::uint32_t>& samples = memory.samples;
    const auto owners = surface_.texel_faces();
    const auto differs = [&](std::uint32_t sample) { return owners[sample] != owners[samples[0]]; };
    if (std::ranges::none_of(samples, differs)) return;
    std::vector<Place>& places = memory.of_samples;
    places.clear();
    for (const std::uint32_t sample : samples) {
      const auto place = memory.places.at(sample);
      places.push_back(place_of(place.face, place.weights));
    }
    const Place kept = at_centre(samples, centre);
    std::size_t count = 0;
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (belong(kept, places[i])) samples[count++] = samples[i];
    if (count > 0) samples.resize(count);
  }

 private:
  [[nodiscard]] Place place_of(std::uint32_t face, const Vec3& weights) const {
    return {surface_.face_charts()[face], normals_ ? normalized(normals_->at(face, weights)) : Vec3{}};
  }
  // The place of the centre on the face of a sample that contains it, or comes closest to that.
  [[nodiscard]] Place at_centre(const std::vector<std::uint32_t>& samples, const Vec2& centre) const {
    double deepest = -kInfinity;
    std::uint32_t best = kNone;
    Vec3 weights_of_best;
    for (const std::uint32_t sample : samples) {
      const std::uint32_t face = surface_.texel_faces()[sample];
      if (face == best) continue;
      const std::array<Vec2, 3> t = surface_.atlas_corners(face);
      const double area = cross(t[1] - t[0], t[2] - t[0]);
      double depth = kInfinity;  // the least distance to the sides, negative outside
      Vec3 weights;
      for (int k = 0; k < 3; ++k) {
        const Vec2 side = t[(k + 2) % 3] - t[(k + 1) % 3];
        weights[k] = cross(t[(k + 1) % 3] - centre, t[(k + 2) % 3] - centre) / area;
        depth = std::min(depth, weights[k] * std::abs(area) / std::hypot(side[0], side[1]));
      }
      if (!(depth > deepest)) continue;
      deepest = depth;
      best = face;
      weights_of_best = weights;
    }
    return place_of(best, weights_of_best);
  }
  [[nodiscard]] bool belong(const Place& a, const Place& b) const {
    constexpr double kLeastCosine = 0.93969262;  // of 20°
    return a.chart == b.chart && (!normals_ || dot(a.normal, b.normal) >= kLeastCosine);
  }

  const Surface& surface_;
  std::optional<map::CornerNormals> normals_;
};

}  // namespace

std::optional<std::uint32_t> sample_side(std::int64_t samples) {
  constexpr std::uint32_t kMost = 8;
  for (std::uint32_t side = 1; side <= kMost; ++side)
    if (samples == std::int64_t{side} * side) return side;
  return std::nullopt;
}

AtlasOptions sample_layout(const AtlasOptions& texels, std::uint32_t side) {
  constexpr std::uint32_t kFewest = 16, kMost = 32768;  // texels per row of a surface
  if (side == 1) return texels;
  if (texels.resolution < kFewest) throw Error("resolution must be 16 at least");
  if (std::uint64_t{std::max(texels.resolution, texels.rows.value_or(0))} * side > kMost)
    throw Error(std::to_string(side * side) + " samples a texel are more than " + std::to_string(kMost) +
                " along a side of the texture");
  AtlasOptions samples = texels;
  samples.resolution *= side;
  if (samples.rows) *samples.rows *= side;
  const std::uint64_t gutter = side * (std::uint64_t{texels.gutter} + 1) - 1;  // so many whole texels
  samples.gutter =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(gutter, std::numeric_limits<std::uint32_t>::max()));
  return samples;
}

TexelMeans mean_of_samples(const SampleGrid& grid, std::size_t components, std::span<const float> samples,
                           SampleKind kind) try {
  const std::size_t rows = texel_rows(grid, components, samples.size()), texels = rows * grid.texels();
  require_memory(texels * (components + 1) * sizeof(float), "the means of samples");
  TexelMeans means{std::vector<float>(texels * components, std::numeric_limits<float>::quiet_NaN()),
                   std::vector<float>(texels)};
  const double all = double{1} * grid.side * grid.side;
  for_each_square(grid, rows, Sum(components), [&](std::size_t texel, std::size_t first, Sum& sum) {
    sum.clear();
    for (std::size_t y = 0; y < grid.side; ++y)
      for (std::size_t x = 0; x < grid.side; ++x)
        sum.add(&samples[(first + y * grid.resolution + x) * components]);
    if (sum.count() == 0) return;
    sum.store(kind, &means.values[texel * components]);
    means.coverage[texel] = static_cast<float>(static_cast<double>(sum.count()) / all);
  });
  return means;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the means of samples");
}

TexelMeans mean_of_samples(const Surface& surface, std::uint32_t side, std::size_t components,
                           std::span<const float> samples, SampleKind kind,
                           const MeshAttribute* normals) try {
  const SampleGrid grid{surface.resolution(), side};
  const std::size_t rows = texel_rows(grid, components, samples.size()), texels = rows * grid.texels();
  if (samples.size() != components * surface.texel_faces().size())
    throw Error("samples must be " + std::to_string(components) + " numbers for each texel of the surface");
  require_memory(texels * (components + 1) * sizeof(float), "the means of samples");
  TexelMeans means{std::vector<float>(texels * components, std::numeric_limits<float>::quiet_NaN()),
                   std::vector<float>(texels)};
  const Sides sides(surface, normals);
  struct Memory {
    Sides::Memory of_sides;
    Sum sum;
  };
  const double all = double{1} * side * side;
  const auto has_values = [&](std::size_t sample) {
    const auto values = samples.subspan(sample * components, components);
    return std::ranges::all_of(values, [](float x) { return std::isfinite(x); });
  };
  for_each_square(grid, rows, Memory{sides.memory(), Sum(components)},
                  [&](std::size_t texel, std::size_t first, Memory& memory) {
                    std::vector<std::uint32_t>& of_texel = memory.of_sides.samples;
                    of_texel.clear();
                    for (std::size_t y = 0; y < side; ++y)
                      for (std::size_t x = 0; x < side; ++x)
                        if (const std::size_t sample = first + y * grid.resolution + x;
                            surface.texel_faces()[sample] != kNone && has_values(sample))
                          of_texel.push_back(static_cast<std::uint32_t>(sample));
                    if (of_texel.empty()) return;
                    means.coverage[texel] = static_cast<float>(static_cast<double>(of_texel.size()) / all);
                    const double half = side / 2.0;
                    const auto column = static_cast<double>(first % grid.resolution);
                    const auto row = static_cast<double>(first / grid.resolution);
                    sides.keep_one({column + half, row + half}, memory.of_sides);
                    memory.sum.clear();
                    for (const std::uint32_t sample : of_texel) memory.sum.add(&samples[sample * components]);
                    memory.sum.store(kind, &means.values[texel * components]);
                  });
  return means;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the means of samples");
}

std::vector<std::uint32_t> most_frequent_samples(const SampleGrid& grid,
                                                 std::span<const std::uint32_t> samples) try {
  const std::size_t rows = texel_rows(grid, 1, samples.size());
  require_memory(rows * grid.texels() * sizeof(std::uint32_t), "the numbers of texels");
  std::vector<std::uint32_t> numbers(rows * grid.texels(), kNone);
  using Numbers = std::vector<std::uint32_t>;
  for_each_square(grid, rows, Numbers(), [&](std::size_t texel, std::size_t first, Numbers& of_texel) {
    of_texel.clear();
    for (std::size_t y = 0; y < grid.side; ++y)
      for (std::size_t x = 0; x < grid.side; ++x)
        if (const std::uint32_t number = samples[first + y * grid.resolution + x]; number != kNone)
          of_texel.push_back(number);
    std::ranges::sort(of_texel);
    std::size_t most = 0;
    for (auto at = of_texel.begin(); at != of_texel.end();) {
      const auto end = std::upper_bound(at, of_texel.end(), *at);
      if (const auto count = static_cast<std::size_t>(end - at); count > most) {
        most = count;
        numbers[texel] = *at;
      }
      at = end;
    }
  });
  return numbers;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the numbers of texels");
}

}  // namespace sdm
