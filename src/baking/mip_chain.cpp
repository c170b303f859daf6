#include "baking/mip_chain.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "baking/srgb.h"
#include "core/parallel.h"

namespace sdm::baking {
namespace {

constexpr float kWhite = 65535;

// What a pixel of the smaller one of two rows covers of the larger one: at most three pixels, as there are
// 2 n or 2 n + 1 for n.
struct Cover {
  std::uint32_t first = 0, count = 0;
  std::array<float, 3> weights{};
};

Cover cover_of(std::uint32_t i, std::uint32_t smaller, std::uint32_t larger) {
  // In units of 1 / smaller of a pixel of the larger row, all are whole.
  const std::uint64_t begin = std::uint64_t{i} * larger, end = begin + larger;
  Cover cover{.first = static_cast<std::uint32_t>(begin / smaller)};
  for (std::uint64_t pixel = cover.first; pixel * smaller < end; ++pixel) {
    const std::uint64_t share = std::min(end, (pixel + 1) * smaller) - std::max(begin, pixel * smaller);
    cover.weights[cover.count++] = static_cast<float>(share) / static_cast<float>(larger);
  }
  return cover;
}

std::uint32_t wrapped(std::int64_t i, std::uint32_t count, TextureWrap wrap) {
  if (i >= 0 && i < count) return static_cast<std::uint32_t>(i);
  const std::int64_t n = count;
  if (wrap == TextureWrap::clamp) return i < 0 ? 0 : count - 1;
  const std::int64_t period = wrap == TextureWrap::mirror ? 2 * n : n,
                     rest = ((i % period) + period) % period;
  return static_cast<std::uint32_t>(rest < n ? rest : period - 1 - rest);
}

// A side beyond these lengths covers many copies of the picture, and so the mean of all of it.
Vec2 limited(const Vec2& side, double most) {
  const double length = std::hypot(side[0], side[1]);
  if (length <= most) return side;
  return std::isfinite(length) ? (most / length) * side : Vec2{most, 0};
}

int samples_along(double length, double spacing) {
  constexpr double kMost = 32;
  return static_cast<int>(std::clamp(std::ceil(length / spacing), 1.0, kMost));
}

}  // namespace

MipChain::MipChain(const Image& image, bool srgb) : image_(&image) {
  const std::size_t values = image.bits == 8 ? 256 : 65536;
  plain_.resize(values);
  for (std::size_t i = 0; i < values; ++i) plain_[i] = static_cast<float>(i) / static_cast<float>(values - 1);
  colors_ = plain_;
  if (srgb) std::ranges::transform(plain_, colors_.begin(), linear_light);
  levels_.push_back({image.width, image.height, {}});
  while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(half(levels_.back()));
}

float MipChain::first_level(std::size_t number, std::uint32_t component) const {
  const std::vector<float>& values = is_alpha(component) ? plain_ : colors_;
  const auto& bytes = image_->bytes;
  return values[image_->bits == 8 ? bytes[number] : bytes[2 * number] | bytes[2 * number + 1] << 8];
}

void MipChain::add(const Level& level, std::uint32_t x, std::uint32_t y, float weight,
                   std::array<float, 4>& sum) const {
  const std::uint32_t components = image_->components;
  const std::size_t first = (std::size_t{y} * level.width + x) * components;
  if (level.numbers.empty())
    for (std::uint32_t k = 0; k < components; ++k) sum[k] += weight * first_level(first + k, k);
  else
    for (std::uint32_t k = 0; k < components; ++k)
      sum[k] += weight * static_cast<float>(level.numbers[first + k]);
}

MipChain::Level MipChain::half(const Level& level) const {
  const std::uint32_t components = image_->components;
  Level next{std::max(1u, level.width / 2), std::max(1u, level.height / 2), {}};
  next.numbers.resize(std::size_t{next.width} * next.height * components);
  std::vector<Cover> columns(next.width);
  for (std::uint32_t x = 0; x < next.width; ++x) columns[x] = cover_of(x, next.width, level.width);
  const float unit = level.numbers.empty() ? kWhite : 1;
  constexpr std::size_t kRowsOfRange = 16;
  parallel_for(next.height, kRowsOfRange, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      const Cover rows = cover_of(static_cast<std::uint32_t>(y), next.height, level.height);
      for (std::size_t x = 0; x < next.width; ++x) {
        const Cover& column = columns[x];
        std::array<float, 4> sum{};
        for (std::uint32_t i = 0; i < rows.count; ++i)
          for (std::uint32_t j = 0; j < column.count; ++j)
            add(level, column.first + j, rows.first + i, unit * rows.weights[i] * column.weights[j], sum);
        for (std::uint32_t k = 0; k < components; ++k)
          next.numbers[(y * next.width + x) * components + k] =
              static_cast<std::uint16_t>(std::min(kWhite, sum[k] + 0.5f));
      }
    }
  });
  return next;
}

void MipChain::add_bilinear(const Level& level, double x, double y, const std::array<TextureWrap, 2>& wrap,
                            std::array<float, 4>& sum) const {
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
  const auto right_share = static_cast<float>(x - 0.5 - left),
             lower_share = static_cast<float>(y - 0.5 - top);
  const auto column = static_cast<std::int64_t>(left), row = static_cast<std::int64_t>(top);
  const std::array<std::uint32_t, 2> xs{wrapped(column, level.width, wrap[0]),
                                        wrapped(column + 1, level.width, wrap[0])},
      ys{wrapped(row, level.height, wrap[1]), wrapped(row + 1, level.height, wrap[1])};
  add(level, xs[0], ys[0], (1 - right_share) * (1 - lower_share), sum);
  add(level, xs[1], ys[0], right_share * (1 - lower_share), sum);
  add(level, xs[0], ys[1], (1 - right_share) * lower_share, sum);
  add(level, xs[1], ys[1], right_share * lower_share, sum);
}

std::array<float, 4> MipChain::mean(const Place& place) const {
  constexpr double kSamples = 3;
  const double extent = std::max(image_->width, image_->height);
  const std::array<Vec2, 2> sides{limited(place.sides[0], 32 * extent), limited(place.sides[1], 32 * extent)};
  const std::array<double, 2> lengths{std::hypot(sides[0][0], sides[0][1]),
                                      std::hypot(sides[1][0], sides[1][1])};
  const double spacing = std::max(1.0, std::min(lengths[0], lengths[1]) / kSamples);
  const std::array<int, 2> counts{samples_along(lengths[0], spacing), samples_along(lengths[1], spacing)};
  const double widest = std::max({1.0, lengths[0] / counts[0], lengths[1] / counts[1]});
  const auto number = std::min<std::size_t>(levels_.size() - 1, static_cast<std::size_t>(std::log2(widest)));
  const Level& level = levels_[number];
  const Vec2 scale{level.width / static_cast<double>(image_->width),
                   level.height / static_cast<double>(image_->height)};
  std::array<float, 4> sum{};
  for (int i = 0; i < counts[0]; ++i)
    for (int j = 0; j < counts[1]; ++j) {
      const Vec2 at =
          place.centre + ((i + 0.5) / counts[0] - 0.5) * sides[0] + ((j + 0.5) / counts[1] - 0.5) * sides[1];
      add_bilinear(level, at[0] * scale[0], at[1] * scale[1], place.wrap, sum);
    }
  const float unit = 1 / (static_cast<float>(counts[0] * counts[1]) * (level.numbers.empty() ? 1 : kWhite));
  for (float& value : sum) value *= unit;
  switch (image_->components) {
    case 1:
      return {sum[0], sum[0], sum[0], 1};
    case 2:
      return {sum[0], sum[0], sum[0], sum[1]};
    case 3:
      return {sum[0], sum[1], sum[2], 1};
    default:
      return sum;
  }
}

}  // namespace sdm::baking
