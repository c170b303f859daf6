#include "atlas/packing/bitmap_bin.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace sdm::atlas {
namespace {

constexpr std::uint64_t kFull = ~std::uint64_t{0};

// Bits shift ... shift + 63 of two words; shift < 64.
inline std::uint64_t shifted(const std::uint64_t* words, std::size_t shift) {
  return words[0] >> shift | words[1] << 1 << (63 - shift);
}
// Bits x ... x + 63.
inline std::uint64_t load(const std::uint64_t* words, std::size_t x) {
  return shifted(words + x / 64, x % 64);
}

// Words per row. All bits of the last two are set, so that load may read past the end.
std::size_t words_per_row(std::uint32_t width) {
  return width / 64 + 3;
}

std::uint32_t level_of(std::uint32_t length) {
  return static_cast<std::uint32_t>(std::bit_width(length)) - 1;
}

// How many positions from that of `free` on have a row whose longest free span is too short for the longest
// run that the stamp has there.
std::uint32_t hopeless_rows(std::span<const std::uint32_t> runs, const std::uint32_t* free) {
  // Signs of differences, several rows at a time. Lengths are below 2^31.
  std::uint32_t signs = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) signs |= free[r] - runs[r];
  if (signs >> 31 == 0) return 0;
  std::size_t full = runs.size() - 1;  // the last row that is too full
  while (free[full] >= runs[full]) --full;
  // Farther down, it meets the rows above in the stamp.
  std::size_t above = full;
  while (above > 0 && free[full] < runs[above - 1]) --above;
  return static_cast<std::uint32_t>(full - above + 1);
}

}  // namespace

BitmapBin::BitmapBin(std::uint32_t width, std::uint32_t height) : BitmapBin(width, height, width, {}) {}

BitmapBin::BitmapBin(std::uint32_t width, std::uint32_t height, std::uint32_t longest,
                     std::span<const std::uint16_t> taken)
    : width_(width),
      height_(height),
      levels_(level_of(std::min(longest, width)) + 1),
      stride_(words_per_row(width)),
      bits_(stride_ * height * levels_, kFull),
      longest_(height, width),
      stale_(height, 0) {
  for (std::uint32_t y = 0; y < height; ++y) {
    std::uint64_t* cells = row(0, y);
    std::fill_n(cells, width / 64, 0);
    cells[width / 64] = kFull << width % 64;
    if (const std::size_t first = std::size_t{y} * width; first < taken.size()) {
      for (std::uint32_t x = 0; x < width; ++x)
        cells[x / 64] |= std::uint64_t{taken[first + x] != 0} << x % 64;
      stale_[y] = 1;
    }
    update_levels(y, 0, width);
  }
}

std::size_t BitmapBin::bytes(std::uint32_t width, std::uint32_t height) {
  return words_per_row(width) * height * (level_of(width) + 1) * sizeof(std::uint64_t);
}

std::optional<BitmapBin::Spot> BitmapBin::first_fit(const Stamp& stamp, std::uint32_t first_y,
                                                    std::uint32_t end_y) {
  if (stamp.width > width_ || stamp.height > height_) return std::nullopt;
  end_y = std::min(end_y, height_ - stamp.height + 1);
  std::vector<std::uint64_t> blocked((width_ - stamp.width) / 64 + 1);
  std::vector<std::uint32_t> longest_runs(stamp.height, 0);  // of each row
  for (const Run& run : stamp.runs) longest_runs[run.row] = std::max(longest_runs[run.row], run.length);
  for (std::uint32_t y = first_y; y < end_y;) {
    if (const std::uint32_t rows = hopeless_rows(longest_runs, &longest_[y]); rows > 0) {
      y += rows;
      continue;
    }
    if (const auto x = fit_in_row(stamp, y, blocked)) return Spot{*x, y};
    if (std::memchr(&stale_[y], 1, stamp.height) != nullptr)
      for (std::uint32_t r = y; r < y + stamp.height; ++r)
        if (stale_[r]) update_longest(r);
    ++y;
  }
  return std::nullopt;
}

std::optional<std::uint32_t> BitmapBin::fit_in_row(const Stamp& stamp, std::uint32_t y,
                                                   std::vector<std::uint64_t>& blocked) const {
  const std::uint32_t positions = width_ - stamp.width + 1;
  std::fill(blocked.begin(), blocked.end(), 0);
  if (positions % 64 != 0) blocked.back() = kFull << positions % 64;
  std::size_t first = 0, last = blocked.size();  // words that may have a free position
  for (const Run& run : stamp.runs) {
    const std::uint32_t level = level_of(run.length);
    const std::uint64_t* words = row(level, y + run.row);
    const std::size_t second = run.begin + run.length - std::bit_floor(std::size_t{run.length});
    const std::uint64_t *a = words + run.begin / 64, *b = words + second / 64;
    const std::size_t shift_a = run.begin % 64, shift_b = second % 64;
    for (std::size_t i = first; i < last; ++i)
      blocked[i] |= shifted(a + i, shift_a) | shifted(b + i, shift_b);
    while (first < last && blocked[first] == kFull) ++first;
    while (first < last && blocked[last - 1] == kFull) --last;
    if (first == last) return std::nullopt;
  }
  return static_cast<std::uint32_t>(64 * first) + static_cast<std::uint32_t>(std::countr_one(blocked[first]));
}

void BitmapBin::place(const Stamp& stamp, Spot spot) {
  for (const Run& run : stamp.runs) {
    const std::uint32_t y = spot.y + run.row, begin = spot.x + run.begin, end = begin + run.length;
    std::uint64_t* cells = row(0, y);
    for (std::uint32_t x = begin; x < end;) {
      const std::uint32_t count = std::min(end - x, 64 - x % 64);
      cells[x / 64] |= kFull >> (64 - count) << x % 64;
      x += count;
    }
    update_levels(y, begin, end);
    stale_[y] = 1;
  }
}

// Updates level k + 1 from level k, whose bits cover half as many cells, after cells [begin, end) of level 0
// have changed: bits from 2^(k+1) before them on are affected. Stops at a level that does not change, since
// the next one depends on it alone.
void BitmapBin::update_levels(std::uint32_t y, std::uint32_t begin, std::uint32_t end) {
  for (std::uint32_t k = 0; k + 1 < levels_; ++k) {
    const std::uint64_t* lower = row(k, y);
    std::uint64_t* upper = row(k + 1, y);
    const std::size_t half = std::size_t{1} << k;
    std::uint64_t changed = 0;
    for (std::size_t i = (begin - std::min<std::size_t>(begin, 2 * half)) / 64; i <= end / 64; ++i) {
      const std::uint64_t bits = 64 * i + half <= width_ ? lower[i] | load(lower, 64 * i + half) : kFull;
      changed |= bits ^ upper[i];
      upper[i] = bits;
    }
    if (changed == 0) return;
  }
}

void BitmapBin::update_longest(std::uint32_t y) {
  const std::uint64_t* cells = row(0, y);
  std::uint32_t longest = 0, run = 0;
  for (std::uint32_t x = 0; x < width_;) {
    const std::uint64_t word = cells[x / 64] >> x % 64;
    const bool taken = word & 1;
    const int same = taken ? std::countr_one(word) : std::countr_zero(word);
    const std::uint32_t count = std::min(64 - x % 64, static_cast<std::uint32_t>(same));
    run = taken ? 0 : run + count;
    longest = std::max(longest, run);
    x += count;
  }
  longest_[y] = longest;
  stale_[y] = 0;
}

}  // namespace sdm::atlas
