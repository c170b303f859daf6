#include "baking/mip_chain.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>

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
  // All limits are whole numbers of 1 / smaller of a pixel of the larger row.
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

// Squares beyond the range, which std::hypot() avoids, make lengths infinite or 0 here.
double length_of(const Vec2& side) {
  return std::sqrt(side[0] * side[0] + side[1] * side[1]);
}

// A side beyond these lengths covers many copies of the picture, and so the mean of all of it.
Vec2 limited(const Vec2& side, double most) {
  const double length = length_of(side);
  if (length <= most) return side;
  return std::isfinite(length) ? (most / length) * side : Vec2{most, 0};
}

int samples_along(double length, double spacing) {
  constexpr double kMost = 32;
  return static_cast<int>(std::clamp(std::ceil(length / spacing), 1.0, kMost));
}

// The numbers of a level, in the form that it has: of component k, number i.
struct BytesOfFile {
  const std::uint8_t* bytes;
  std::array<const float*, 4> values;  // of each number, by component

  float operator()(std::size_t i, std::size_t k) const { return values[k][bytes[i]]; }
};
struct WordsOfFile {
  const std::uint8_t* bytes;
  std::array<const float*, 4> values;

  float operator()(std::size_t i, std::size_t k) const {
    return values[k][bytes[2 * i] | bytes[2 * i + 1] << 8];
  }
};
struct Words {
  const std::uint16_t* numbers;

  float operator()(std::size_t i, std::size_t) const { return static_cast<float>(numbers[i]); }
};

template <std::size_t N, class Numbers>
void add_pixel(const Numbers& numbers, std::size_t pixel, float weight, std::array<float, 4>& sum) {
  for (std::size_t k = 0; k < N; ++k) sum[k] += weight * numbers(pixel * N + k, k);
}

// The floor of numbers far from the largest ones: std::floor() is a call where SSE 4.1 is not assumed.
std::int64_t floor_of(double x) {
  const auto whole = static_cast<std::int64_t>(x);
  return whole - (static_cast<double>(whole) > x ? 1 : 0);
}

// The four pixels around a place, and their shares.
struct Bilinear {
  std::array<std::size_t, 4> numbers;
  std::array<float, 4> weights;

  Bilinear(double x, double y, std::uint32_t width, std::uint32_t height,
           const std::array<TextureWrap, 2>& wrap) {
    const std::int64_t column = floor_of(x - 0.5), row = floor_of(y - 0.5);
    const auto right = static_cast<float>(x - 0.5 - static_cast<double>(column)),
               lower = static_cast<float>(y - 0.5 - static_cast<double>(row));
    const std::size_t left = wrapped(column, width, wrap[0]), beside = wrapped(column + 1, width, wrap[0]),
                      above = std::size_t{wrapped(row, height, wrap[1])} * width,
                      below = std::size_t{wrapped(row + 1, height, wrap[1])} * width;
    numbers = {above + left, above + beside, below + left, below + beside};
    weights = {(1 - right) * (1 - lower), right * (1 - lower), (1 - right) * lower, right * lower};
  }
};

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

template <class Call>
void MipChain::with_numbers(const Level& level, const Call& call) const {
  const auto with_count = [&](const auto& numbers) {
    switch (image_->components) {
      case 1:
        return call(numbers, std::integral_constant<std::size_t, 1>{});
      case 2:
        return call(numbers, std::integral_constant<std::size_t, 2>{});
      case 3:
        return call(numbers, std::integral_constant<std::size_t, 3>{});
      default:
        return call(numbers, std::integral_constant<std::size_t, 4>{});
    }
  };
  if (!level.numbers.empty()) return with_count(Words{level.numbers.data()});
  std::array<const float*, 4> values{};
  for (std::uint32_t k = 0; k < 4; ++k) values[k] = is_alpha(k) ? plain_.data() : colors_.data();
  if (image_->bits == 8) return with_count(BytesOfFile{image_->bytes.data(), values});
  with_count(WordsOfFile{image_->bytes.data(), values});
}

MipChain::Level MipChain::half(const Level& level) const {
  const std::uint32_t components = image_->components;
  Level next{std::max(1u, level.width / 2), std::max(1u, level.height / 2), {}};
  next.numbers.resize(std::size_t{next.width} * next.height * components);
  std::vector<Cover> columns(next.width);
  for (std::uint32_t x = 0; x < next.width; ++x) columns[x] = cover_of(x, next.width, level.width);
  const float unit = level.numbers.empty() ? kWhite : 1;
  constexpr std::size_t kRowsOfRange = 16;
  with_numbers(level, [&](const auto& numbers, auto count) {
    constexpr std::size_t kCount = decltype(count)::value;
    parallel_for(next.height, kRowsOfRange, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y) {
        const Cover rows = cover_of(static_cast<std::uint32_t>(y), next.height, level.height);
        for (std::size_t x = 0; x < next.width; ++x) {
          const Cover& column = columns[x];
          std::array<float, 4> sum{};
          for (std::uint32_t i = 0; i < rows.count; ++i)
            for (std::uint32_t j = 0; j < column.count; ++j)
              add_pixel<kCount>(numbers, std::size_t{rows.first + i} * level.width + column.first + j,
                                unit * rows.weights[i] * column.weights[j], sum);
          for (std::uint32_t k = 0; k < components; ++k)
            next.numbers[(y * next.width + x) * components + k] =
                static_cast<std::uint16_t>(std::min(kWhite, sum[k] + 0.5f));
        }
      }
    });
  });
  return next;
}

std::array<float, 4> MipChain::mean(const Place& place) const {
  constexpr double kSamples = 3;
  const double extent = std::max(image_->width, image_->height);
  const std::array<Vec2, 2> sides{limited(place.sides[0], 32 * extent), limited(place.sides[1], 32 * extent)};
  const std::array<double, 2> lengths{length_of(sides[0]), length_of(sides[1])};
  const double spacing = std::max(1.0, std::min(lengths[0], lengths[1]) / kSamples);
  const std::array<int, 2> counts{samples_along(lengths[0], spacing), samples_along(lengths[1], spacing)};
  const double widest = std::max({1.0, lengths[0] / counts[0], lengths[1] / counts[1]});
  const auto number = std::min<std::size_t>(levels_.size() - 1, static_cast<std::size_t>(std::ilogb(widest)));
  const Level& level = levels_[number];
  const Vec2 scale{level.width / static_cast<double>(image_->width),
                   level.height / static_cast<double>(image_->height)};
  std::array<float, 4> sum{};
  with_numbers(level, [&](const auto& numbers, auto count) {
    constexpr std::size_t kCount = decltype(count)::value;
    for (int i = 0; i < counts[0]; ++i)
      for (int j = 0; j < counts[1]; ++j) {
        const Vec2 at = place.centre + ((i + 0.5) / counts[0] - 0.5) * sides[0] +
                        ((j + 0.5) / counts[1] - 0.5) * sides[1];
        const Bilinear pixels(at[0] * scale[0], at[1] * scale[1], level.width, level.height, place.wrap);
        for (std::size_t n = 0; n < 4; ++n)
          add_pixel<kCount>(numbers, pixels.numbers[n], pixels.weights[n], sum);
      }
  });
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
