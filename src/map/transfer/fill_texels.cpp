#include "map/transfer/fill_texels.h"

#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <vector>

#include "atlas/gutter.h"
#include "core/parallel.h"

namespace sdm::map {
namespace {

constexpr std::size_t kRowsOfTask = 16;

// An image of which each texel is the mean of four of the next finer one, with the share of it that has
// values.
struct Level {
  std::size_t columns, rows;
  std::vector<float> weights;
  std::vector<float> means;  // one per component; unspecified where the weight is 0
};

// The finest image, and the coarser ones.
class Pyramid {
 public:
  Pyramid(std::size_t columns, std::size_t rows, std::size_t components)
      : columns_(columns), rows_(rows), components_(components) {
    for (std::size_t w = columns, h = rows; w > 1 || h > 1;) {
      w = (w + 1) / 2, h = (h + 1) / 2;
      levels_.push_back({w, h, std::vector<float>(w * h), std::vector<float>(w * h * components)});
    }
  }

  void push(std::span<const float> weights, std::span<const float> values) {
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      if (i > 0)
        push(levels_[i - 1].columns, levels_[i - 1].rows, levels_[i - 1].weights, levels_[i - 1].means,
             levels_[i]);
      else
        push(columns_, rows_, weights, values, levels_[i]);
    }
  }

  // Completes the means of all levels, from the coarsest on, and the values of weight 0.
  void pull(std::span<const float> weights, std::span<float> values) {
    for (std::size_t i = levels_.size(); i-- > 0;) {
      if (i > 0)
        pull(levels_[i], levels_[i - 1].columns, levels_[i - 1].rows, levels_[i - 1].weights,
             levels_[i - 1].means);
      else
        pull(levels_[i], columns_, rows_, weights, values);
    }
  }

 private:
  void push(std::size_t columns, std::size_t rows, std::span<const float> weights,
            std::span<const float> values, Level& into) const {
    parallel_for(into.rows, kRowsOfTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y)
        for (std::size_t x = 0; x < into.columns; ++x) {
          const std::size_t to = y * into.columns + x;
          float total = 0;
          float* const mean = &into.means[to * components_];
          for (std::size_t sy = 2 * y; sy < std::min(2 * y + 2, rows); ++sy)
            for (std::size_t sx = 2 * x; sx < std::min(2 * x + 2, columns); ++sx) {
              const std::size_t from = sy * columns + sx;
              if (weights[from] == 0) continue;
              total += weights[from];
              for (std::size_t k = 0; k < components_; ++k)
                mean[k] += weights[from] * values[from * components_ + k];
            }
          if (total == 0) continue;
          for (std::size_t k = 0; k < components_; ++k) mean[k] /= total;
          into.weights[to] = std::min(1.f, total);
        }
    });
  }

  // Blends the means of the coarser level, interpolated, into what lacks weight.
  void pull(const Level& coarse, std::size_t columns, std::size_t rows, std::span<const float> weights,
            std::span<float> values) const {
    parallel_for(rows, kRowsOfTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y)
        for (std::size_t x = 0; x < columns; ++x) {
          const std::size_t to = y * columns + x;
          if (weights[to] >= 1) continue;
          // The centre of a texel lies a quarter of a coarse texel beside that of its parent.
          const std::array<std::size_t, 2> xs{x / 2, neighbour(x, coarse.columns)},
              ys{y / 2, neighbour(y, coarse.rows)};
          for (std::size_t k = 0; k < components_; ++k) {
            const auto mean = [&](std::size_t i, std::size_t j) {
              return coarse.means[(ys[j] * coarse.columns + xs[i]) * components_ + k];
            };
            const float near_row = 0.75f * mean(0, 0) + 0.25f * mean(1, 0),
                        far_row = 0.75f * mean(0, 1) + 0.25f * mean(1, 1);
            float& value = values[to * components_ + k];
            const float between = 0.75f * near_row + 0.25f * far_row;
            value = weights[to] == 0 ? between : weights[to] * value + (1 - weights[to]) * between;
          }
        }
    });
  }

  static std::size_t neighbour(std::size_t i, std::size_t count) {
    const std::size_t parent = i / 2;
    if (i % 2 == 0) return parent > 0 ? parent - 1 : parent;
    return std::min(parent + 1, count - 1);
  }

  std::size_t columns_, rows_, components_;
  std::vector<Level> levels_;
};

}  // namespace

void fill_free_texels(std::uint32_t resolution, std::span<const TexelState> states, std::uint32_t gutter,
                      std::size_t components, std::span<float> values) {
  if (std::ranges::count(states, TexelState::valued) == 0) return;
  const std::size_t rows = states.size() / resolution;
  std::vector<std::uint32_t> owners(states.size());
  std::vector<float> weights(states.size());
  for (std::size_t i = 0; i < states.size(); ++i)
    owners[i] = states[i] == TexelState::valued ? static_cast<std::uint32_t>(i) : kNone;
  const atlas::Gutter sources(resolution, owners, gutter);
  parallel_for(rows, kRowsOfTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * resolution; i < end * resolution; ++i) {
      weights[i] = states[i] == TexelState::valued;
      if (states[i] != TexelState::free) continue;
      const std::uint32_t source = sources.source(static_cast<std::uint32_t>(i % resolution),
                                                  static_cast<std::uint32_t>(i / resolution));
      if (source == kNone) continue;
      weights[i] = 1;
      std::copy_n(&values[source * components], components, &values[i * components]);
    }
  });
  Pyramid pyramid(resolution, rows, components);
  pyramid.push(weights, values);
  // What has a face keeps what it has.
  for (std::size_t i = 0; i < states.size(); ++i)
    if (states[i] == TexelState::missing) weights[i] = 1;
  pyramid.pull(weights, values);
}

}  // namespace sdm::map
