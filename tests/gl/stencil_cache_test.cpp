// The stencil cache against a simple model: a list in order of use.
#include "gl/stencil_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace sdm::gl {
namespace {

class StencilCacheOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Values, StencilCacheOf, testing::Values(1, 2, 7, 255));

TEST_P(StencilCacheOf, MatchesAnLruModel) {
  struct Entry {
    std::uint32_t face;
    int value;
  };
  const auto capacity = static_cast<std::size_t>(GetParam());
  StencilCache cache(GetParam());
  std::vector<Entry> model;  // the least recently used first
  std::mt19937 random(1);
  std::uint64_t hits = 0, evictions = 0;
  for (int i = 0; i < 20000; ++i) {
    // Sometimes near the previous faces, sometimes anywhere.
    const auto faces = static_cast<std::uint32_t>(random() % 2 ? 2 * GetParam() + 1 : 600);
    const std::uint32_t face = static_cast<std::uint32_t>(random()) % faces;
    const StencilCache::Use use = cache.use(face);
    const auto found = std::ranges::find(model, face, &Entry::face);
    ASSERT_EQ(use.hit, found != model.end());
    if (found != model.end()) {
      ++hits;
      ASSERT_EQ(use.value, found->value);
      ASSERT_EQ(use.evicted, StencilCache::kNobody);
      std::rotate(found, found + 1, model.end());
      continue;
    }
    if (model.size() == capacity) {
      ++evictions;
      ASSERT_EQ(use.evicted, model.front().face);
      ASSERT_EQ(use.value, model.front().value);
      model.erase(model.begin());
    } else {
      ASSERT_EQ(use.evicted, StencilCache::kNobody);
    }
    ASSERT_GE(use.value, 1);
    ASSERT_LE(use.value, GetParam());
    ASSERT_TRUE(std::ranges::none_of(model, [&](const Entry& e) { return e.value == use.value; }));
    model.push_back({face, use.value});
  }
  EXPECT_EQ(cache.lookups(), 20000u);
  EXPECT_EQ(cache.hits(), hits);
  EXPECT_EQ(cache.evictions(), evictions);
  EXPECT_GT(hits, 0u);
}

}  // namespace
}  // namespace sdm::gl
