#include "closest/blocks.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"
#include "surface/surface_data.h"

namespace sdm::closest {

std::size_t block_size(std::size_t count) {
  constexpr std::size_t kEnough = 32, kSmallestBlock = 16, kFan = 4;
  std::size_t size = kLargestBlock;
  while (size > kSmallestBlock && count < kEnough * size) size /= kFan;
  return size;
}

namespace {

/// Calls body(begin, end) for the blocks of a range.
void for_blocks(const SampleRange& range, std::size_t size, const Progress& progress, std::string_view step,
                const std::function<void(std::size_t, std::size_t)>& body) {
  const std::size_t end = range.first + range.count;
  parallel_for((range.count + size - 1) / size, 1, progress, step, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t begin = range.first + size * i;
      body(begin, std::min(end, begin + size));
    }
  });
}

}  // namespace

void for_each_block(std::size_t count, const Progress& progress, std::string_view step,
                    const std::function<void(std::size_t, std::size_t)>& body) {
  for_blocks({0, count}, block_size(count), progress, step, body);
}

void for_each_sample_block(const Surface& surface, const Progress& progress, std::string_view step,
                           const std::function<void(std::size_t, std::span<const Vec3>)>& body) {
  for_each_sample_block(surface, {0, surface.sample_texels().size()}, progress, step, body);
}

void for_each_sample_block(const Surface& surface, const SampleRange& range, const Progress& progress,
                           std::string_view step,
                           const std::function<void(std::size_t, std::span<const Vec3>)>& body) {
  const std::size_t size = block_size(surface.sample_texels().size());
  for_blocks(range, size, progress, step, [&](std::size_t begin, std::size_t end) {
    // The points of one block fit in the cache; those of all samples would not.
    thread_local std::vector<Vec3> points;
    points.resize(end - begin);
    internals(surface).place_samples(begin, points);
    body(begin, points);
  });
}

}  // namespace sdm::closest
