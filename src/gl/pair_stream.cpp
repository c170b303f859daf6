#include "gl/pair_stream.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "core/stopwatch.h"

namespace sdm::gl {
namespace {

// The number of polygons that completes a batch.
constexpr std::size_t kBatchPolygons = 1 << 15;
// Leaves of O2's tree processed at once: few at first, more as long as they produce no more than a batch.
// Memory then rarely exceeds two batches; in the worst case, all sites of kMostLeaves leaves meet all domains
// of a block.
constexpr std::size_t kFirstLeaves = 4, kMostLeaves = 64;

}  // namespace

PairStream::PairStream(const SiteIndex& sites, const DomainTree& tree, double reach, const RasterRules& rules,
                       Rasteriser& rasteriser, GlReport::Times& time)
    : sites_(sites),
      tree_(tree),
      reach_(reach),
      rules_(rules),
      rasteriser_(rasteriser),
      time_(time),
      parts_(kMostLeaves),
      counts_(kMostLeaves) {}

void PairStream::draw(const DomainBlock& block, const std::function<void(double)>& progress) {
  Stopwatch watch;
  const std::vector<std::uint32_t> leaves = leaves_within_bound(sites_, tree_, block, total_);
  time_.cull += watch.lap();
  std::size_t at_once = kFirstLeaves;
  for (std::size_t begin = 0; begin < leaves.size();) {
    const std::size_t count = std::min(at_once, leaves.size() - begin);
    const std::uint64_t before = total_.polygons;
    cull(std::span(leaves).subspan(begin, count), block);
    draw_parts(count);
    const std::uint64_t made = total_.polygons - before;
    at_once = std::clamp(made > kBatchPolygons ? count / 2 : 2 * count, std::size_t{1}, kMostLeaves);
    begin += count;
    progress(static_cast<double>(begin) / static_cast<double>(leaves.size()));
  }
}

void PairStream::cull(std::span<const std::uint32_t> leaves, const DomainBlock& block) {
  Stopwatch watch;
  parallel_for(leaves.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      draw_leaf(sites_, leaves[i], tree_, block, reach_, rules_, parts_[i], counts_[i]);
  });
  for (std::size_t i = 0; i < leaves.size(); ++i) total_ += std::exchange(counts_[i], {});
  time_.cull += watch.lap();
}

void PairStream::draw_parts(std::size_t count) {
  Stopwatch watch;
  for (std::size_t i = 0; i < count; ++i) {
    batch_.append(parts_[i]);
    parts_[i].clear();
    if (batch_.size() >= kBatchPolygons) finish();
  }
  time_.draw += watch.lap();
}

void PairStream::finish() {
  rasteriser_.draw(batch_);
  batch_.clear();
}

}  // namespace sdm::gl
