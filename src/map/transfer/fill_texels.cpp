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

// The finest image, and the coarser ones. N: the number of components, or 0 where it is not known at compile
// time.
template <std::size_t N>
class Pyramid {
 public:
  Pyramid(std::size_t columns, std::size_t rows, std::size_t components)
      : columns_(columns), rows_(rows), known_components_(components) {
    for (std::size_t w = columns, h = rows; w > 1 || h > 1;) {
      w = (w + 1) / 2;
      h = (h + 1) / 2;
      levels_.push_back({w, h, std::vector<float>(w * h), std::vector<float>(w * h * components)});
    }
  }

  void push(std::span<const TexelState> states, std::span<const float> values) {
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      if (i > 0)
        push<float>(levels_[i - 1].columns, levels_[i - 1].rows, levels_[i - 1].weights, levels_[i - 1].means,
                    levels_[i]);
      else
        push<TexelState>(columns_, rows_, states, values, levels_[i]);
    }
  }

  // Completes the means of all levels, from the coarsest on, and the values of free texels.
  void pull(std::span<const TexelState> states, std::span<float> values) {
    for (std::size_t i = levels_.size(); i-- > 0;) {
      if (i > 0)
        pull<float>(levels_[i], levels_[i - 1].columns, levels_[i - 1].rows, levels_[i - 1].weights,
                    levels_[i - 1].means);
      else
        pull<TexelState>(levels_[i], columns_, rows_, states, values);
    }
  }

 private:
  [[nodiscard]] std::size_t components() const { return N == 0 ? known_components_ : N; }

  // The share of a texel whose value counts as a mean.
  static float weight(float weight) { return weight; }
  static float weight(TexelState state) { return state == TexelState::valued ? 1 : 0; }
  // Whether a texel keeps what it has.
  static bool is_final(float weight) { return weight >= 1; }
  static bool is_final(TexelState state) { return state != TexelState::free; }

  template <class Weight>
  void push(std::size_t columns, std::size_t rows, std::span<const Weight> weights,
            std::span<const float> values, Level& into) const {
    parallel_for(into.rows, kRowsOfTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y)
        for (std::size_t x = 0; x < into.columns; ++x) {
          const std::size_t from = 2 * y * columns + 2 * x, to = y * into.columns + x;
          const std::size_t right = 2 * x + 1 < columns ? 1 : 0, below = 2 * y + 1 < rows ? columns : 0;
          float* const mean = &into.means[to * components()];
          float total = 0;
          const auto add = [&](std::size_t texel) {
            const float share = weight(weights[texel]);
            if (share == 0) return;  // its value may be NaN
            total += share;
            for (std::size_t k = 0; k < components(); ++k)
              mean[k] += share * values[texel * components() + k];
          };
          add(from);
          if (right > 0) add(from + right);
          if (below > 0) add(from + below);
          if (right > 0 && below > 0) add(from + right + below);
          if (total == 0) continue;
          const float per_total = 1 / total;
          for (std::size_t k = 0; k < components(); ++k) mean[k] *= per_total;
          into.weights[to] = std::min(1.f, total);
        }
    });
  }

  // Blends the means of the coarser level, interpolated, into what lacks weight.
  template <class Weight>
  void pull(const Level& coarse, std::size_t columns, std::size_t rows, std::span<const Weight> weights,
            std::span<float> values) const {
    parallel_for(rows, kRowsOfTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y)
        for (std::size_t x = 0; x < columns; ++x) {
          const std::size_t to = y * columns + x;
          if (is_final(weights[to])) continue;
          const float share = weight(weights[to]);
          // The centre of a texel lies a quarter of a coarse texel beside that of its parent.
          const std::array<std::size_t, 2> xs{x / 2, neighbour(x, coarse.columns)},
              ys{y / 2, neighbour(y, coarse.rows)};
          for (std::size_t k = 0; k < components(); ++k) {
            const auto mean = [&](std::size_t i, std::size_t j) {
              return coarse.means[(ys[j] * coarse.columns + xs[i]) * components() + k];
            };
            const float near_row = 0.75f * mean(0, 0) + 0.25f * mean(1, 0),
                        far_row = 0.75f * mean(0, 1) + 0.25f * mean(1, 1);
            float& value = values[to * components() + k];
            const float between = 0.75f * near_row + 0.25f * far_row;
            value = share == 0 ? between : share * value + (1 - share) * between;
          }
        }
    });
  }

  static std::size_t neighbour(std::size_t i, std::size_t count) {
    const std::size_t parent = i / 2;
    if (i % 2 == 0) return parent > 0 ? parent - 1 : parent;
    return std::min(parent + 1, count - 1);
  }

  std::size_t columns_, rows_, known_components_;
  std::vector<Level> levels_;
};

template <std::size_t N>
void fill_beyond_gutters(std::size_t columns, std::span<const TexelState> states, std::size_t components,
                         std::span<float> values) {
  Pyramid<N> pyramid(columns, states.size() / columns, components);
  pyramid.push(states, values);
  pyramid.pull(states, values);
}

// Fills the texels within the gutter, which then are valued.
void fill_gutters(std::uint32_t resolution, std::span<TexelState> states, std::uint32_t gutter,
                  std::size_t components, std::span<float> values) {
  const std::size_t rows = states.size() / resolution;
  const auto valued = [&](std::size_t i) { return states[i] == TexelState::valued; };
  const atlas::Gutter sources(resolution, rows, valued, gutter);
  parallel_for(rows, kRowsOfTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * resolution; i < end * resolution; ++i) {
      if (states[i] != TexelState::free) continue;
      const std::uint32_t source = sources.source(static_cast<std::uint32_t>(i % resolution),
                                                  static_cast<std::uint32_t>(i / resolution));
      if (source == kNone) continue;
      states[i] = TexelState::valued;
      std::copy_n(&values[source * components], components, &values[i * components]);
    }
  });
}

}  // namespace

void fill_free_texels(std::uint32_t resolution, std::span<TexelState> states, std::uint32_t gutter,
                      std::size_t components, std::span<float> values) {
  if (std::ranges::find(states, TexelState::valued) == states.end()) return;
  fill_gutters(resolution, states, gutter, components, values);
  switch (components) {
    case 1:
      return fill_beyond_gutters<1>(resolution, states, components, values);
    case 3:
      return fill_beyond_gutters<3>(resolution, states, components, values);
    case 4:
      return fill_beyond_gutters<4>(resolution, states, components, values);
    default:
      return fill_beyond_gutters<0>(resolution, states, components, values);
  }
}

}  // namespace sdm::map
