#include "io/mesh/frames/match_polygons.h"

#include <algorithm>
#include <compare>

namespace sdm::io {
namespace {

// The corner from which the cycle is smallest in lexicographic order. Cost: linear, since each comparison
// that ends rules out the starts of all that it has compared.
std::uint32_t smallest_rotation(std::span<const std::uint32_t> cycle) {
  const std::size_t n = cycle.size();
  std::size_t a = 0, b = 1;  // the candidates
  for (std::size_t length = 0; a < n && b < n && length < n;) {
    const std::uint32_t x = cycle[(a + length) % n], y = cycle[(b + length) % n];
    if (x == y) {
      ++length;
      continue;
    }
    (x > y ? a : b) += length + 1;
    if (a == b) ++b;
    length = 0;
  }
  return static_cast<std::uint32_t>(std::min(a, b));
}

// A polygon, with its cycle from the smallest rotation on.
struct Entry {
  std::span<const std::uint32_t> cycle;
  std::uint32_t polygon, start;

  [[nodiscard]] std::uint32_t at(std::size_t i) const {
    const std::size_t place = start + i;
    return cycle[place < cycle.size() ? place : place - cycle.size()];
  }
  [[nodiscard]] std::strong_ordering compare_cycles(const Entry& other) const {
    if (const auto order = cycle.size() <=> other.cycle.size(); order != 0) return order;
    for (std::size_t i = 0; i < cycle.size(); ++i)
      if (const auto order = at(i) <=> other.at(i); order != 0) return order;
    return std::strong_ordering::equal;
  }
  [[nodiscard]] bool operator<(const Entry& other) const {
    const auto order = compare_cycles(other);
    return order != 0 ? order < 0 : polygon < other.polygon;
  }
};

bool has_number(std::span<const std::uint32_t> cycle) {
  return std::ranges::find(cycle, kNone) == cycle.end();
}

// The polygons that are still free and whose vertices all have numbers, sorted.
template <class Free>
std::vector<Entry> sorted(const PolygonCycles& polygons, const Free& is_free) {
  std::vector<Entry> entries;
  for (std::uint32_t p = 0; p < polygons.size(); ++p)
    if (is_free(p) && has_number(polygons[p]))
      entries.push_back({polygons[p], p, smallest_rotation(polygons[p])});
  std::ranges::sort(entries, [](const Entry& a, const Entry& b) { return a < b; });
  return entries;
}

}  // namespace

void match_polygons(const PolygonCycles& before, const PolygonCycles& now,
                    std::vector<PolygonMatch>& matches) {
  std::vector<std::uint8_t> taken(before.size(), 0);
  for (const PolygonMatch& match : matches)
    if (match.polygon != kNone) taken[match.polygon] = 1;
  for (std::uint32_t p = 0; p < std::min(before.size(), now.size()); ++p)
    if (matches[p].polygon == kNone && !taken[p] && has_number(now[p]) &&
        std::ranges::equal(before[p], now[p])) {
      matches[p] = {p, 0};
      taken[p] = 1;
    }
  const std::vector<Entry> earlier = sorted(before, [&](std::uint32_t p) { return !taken[p]; });
  const std::vector<Entry> later = sorted(now, [&](std::uint32_t p) { return matches[p].polygon == kNone; });
  for (auto e = earlier.begin(), l = later.begin(); e != earlier.end() && l != later.end();) {
    const auto order = e->compare_cycles(*l);
    if (order == 0) {
      const auto n = static_cast<std::uint32_t>(l->cycle.size());
      matches[l->polygon] = {e->polygon, (l->start + n - e->start) % n};
    }
    e += order <= 0;
    l += order >= 0;
  }
}

}  // namespace sdm::io
