#include <sdm/error.h>
#include <sdm/statistics.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "atlas/layout.h"
#include "core/cancellation.h"
#include "core/memory.h"
#include "core/parallel.h"

namespace sdm {

TemporalMaps::TemporalMaps(State state) : state_(std::move(state)) {
  const std::size_t n = state_.least.size();
  const bool fits = state_.maps == 0 ? n == 0 : n > 0 && state_.resolution > 0 && n % state_.resolution == 0;
  if (!fits || state_.largest.size() != n || state_.sum.size() != n)
    throw Error("maps over time of " + std::to_string(state_.resolution) +
                "² texels cannot continue from a state of another size; give a complete one");
}

namespace {

// Changes the state by a map of its size.
void add_to(TemporalMaps::State& state, const DistanceMap& map) {
  constexpr std::size_t kBlock = 1 << 16;
  const std::size_t texels = state.sum.size();
  std::vector<std::uint8_t> added((texels + kBlock - 1) / kBlock, 0);  // of each block
  const auto add_block = [&](std::size_t block) {
    for (std::size_t i = block * kBlock; i < std::min(texels, (block + 1) * kBlock); ++i) {
      const float d = map.distance[i];
      state.sum[i] += d;  // NaN if either is
      // NaN in either operand makes the minimum and maximum NaN as well.
      if (d < state.least[i] || std::isnan(d)) state.least[i] = d;
      if (d > state.largest[i] || std::isnan(d)) state.largest[i] = d;
    }
    added[block] = 1;
  };
  try {
    parallel_for(added.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t block = begin; block < end; ++block) add_block(block);
    });
  } catch (...) {
    // There was no memory for a task. The change is in place: it has to be completed.
    for (std::size_t block = 0; block < added.size(); ++block)
      if (!added[block]) add_block(block);
  }
}

}  // namespace

void TemporalMaps::add(const DistanceMap& map) try {
  const Uncancellable whole;
  State& state = state_;
  if (state.maps == 0) {
    const auto texels = std::span(map.distance).first(map.texels());
    state = {.maps = 1,
             .resolution = map.resolution,
             .least = {texels.begin(), texels.end()},
             .largest = {texels.begin(), texels.end()},
             .sum = {texels.begin(), texels.end()}};
    return;
  }
  if (map.resolution != state.resolution)
    throw Error("a map of " + atlas::size_text(map.resolution, map.rows()) +
                " texels cannot be added to maps of " +
                atlas::size_text(state.resolution, state.sum.size() / state.resolution));
  if (map.texels() != state.sum.size())
    throw Error("a map of " + std::to_string(map.rows()) + " rows of texels cannot be added to maps of " +
                std::to_string(state.sum.size() / state.resolution));
  add_to(state, map);
  ++state.maps;
} catch (const std::bad_alloc&) {
  throw out_of_memory("maps over time");
}

void TemporalMaps::follow_edit(std::span<const std::uint32_t> before, const Surface& edited) try {
  const Uncancellable whole;
  if (state_.maps == 0) return;
  const std::span<const std::uint32_t> now = edited.texel_faces();
  if (before.size() != state_.sum.size() || edited.resolution() != state_.resolution ||
      now.size() < before.size())
    throw Error("maps over time of " + std::to_string(state_.sum.size()) +
                " texels cannot follow the edit of an atlas of " + std::to_string(before.size()) +
                "; they belong to another surface");
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  reserve_for(state_.least, now.size());
  reserve_for(state_.largest, now.size());
  reserve_for(state_.sum, now.size());
  state_.least.resize(now.size(), kNaN);  // from here on, nothing fails
  state_.largest.resize(now.size(), kNaN);
  state_.sum.resize(now.size(), kNaN);
  for (std::size_t i = 0; i < before.size(); ++i)
    if (now[i] != before[i]) {
      state_.least[i] = state_.largest[i] = kNaN;
      state_.sum[i] = kNaN;
    }
} catch (const std::bad_alloc&) {
  throw out_of_memory("maps over time");
}

std::vector<float> TemporalMaps::mean() const try {
  std::vector<float> mean(state_.sum.size());
  for (std::size_t i = 0; i < mean.size(); ++i)
    mean[i] = static_cast<float>(state_.sum[i] / static_cast<double>(state_.maps));
  return mean;
} catch (const std::bad_alloc&) {
  throw out_of_memory("maps over time");
}

}  // namespace sdm
