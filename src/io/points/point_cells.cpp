#include "io/points/point_cells.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/disjoint_sets.h"
#include "geometry/vec.h"

namespace sdm::io {
namespace {

// A key has 20 bits for each coordinate and 2 for the side of the limits.
constexpr int kBits = 20;
constexpr std::int64_t kMiddle = std::int64_t{1} << (kBits - 1), kLast = 2 * kMiddle - 1;
constexpr std::size_t kMostCells = std::size_t{1} << 18;

std::uint64_t packed(const std::array<std::int64_t, 3>& c, std::uint64_t side) {
  std::uint64_t key = side;
  for (const std::int64_t x : c) key = key << kBits | static_cast<std::uint64_t>(x);
  return key;
}

std::array<std::int64_t, 3> coordinates(std::uint64_t key) {
  const auto at = [&](int shift) { return static_cast<std::int64_t>(key >> shift & kLast); };
  return {at(2 * kBits), at(kBits), at(0)};
}

}  // namespace

void UsualBox::add(const Vec3& point) {
  if (count_++ % stride_ != 0) return;
  sample_.push_back(point);
  if (sample_.size() < kMost) return;
  for (std::size_t i = 0; i < sample_.size() / 2; ++i) sample_[i] = sample_[2 * i];
  sample_.resize(sample_.size() / 2);
  stride_ *= 2;
}

Box UsualBox::box() const {
  Box box;
  if (sample_.empty()) return box;
  const std::size_t outside = sample_.size() / 200;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> along;
    for (const Vec3& p : sample_) along.push_back(p[k]);
    std::ranges::sort(along);
    box.lo[k] = along[outside], box.hi[k] = along[along.size() - 1 - outside];
  }
  return box;
}

void CellPoints::add(const CellPoints& other) {
  const std::uint64_t all = points + other.points;
  if (points == 0 || other.excess > excess || (other.excess == excess && other.number < number))
    *this = other;
  points = all;
}

PointCells::PointCells(const Box& usual, std::uint64_t points) : origin_(usual.lo) {
  constexpr double kFinest = 1.0 / 512, kSpacings = 4;
  const double apart = kSpacings / std::sqrt(static_cast<double>(std::max<std::uint64_t>(points, 1)));
  const double size = diagonal(usual);
  width_ = size > 0 && std::isfinite(size) ? size * std::max(kFinest, apart) : 1;
  if (!finite(origin_)) origin_ = {};
}

PointCells::Key PointCells::key(const Vec3& at, int side) const {
  std::array<std::int64_t, 3> c{};
  for (int k = 0; k < 3; ++k) {
    const double cell = std::floor((at[k] - origin_[k]) / width_);
    const auto middle = static_cast<double>(kMiddle);
    c[k] = kMiddle + static_cast<std::int64_t>(std::clamp(cell, -middle, middle - 1));
  }
  return packed(c, static_cast<std::uint64_t>(side));
}

void PointCells::add(const Vec3& at, int side, const CellPoints& points) {
  cells_[key(at, side)].add(points);
  if (cells_.size() > kMostCells) coarsen();
}

void PointCells::coarsen() {
  // Cells are halved about the origin: c − middle rounds down.
  std::unordered_map<Key, CellPoints> coarse;
  for (const auto& [key, points] : cells_) {
    auto c = coordinates(key);
    for (std::int64_t& x : c) x = kMiddle + ((x - kMiddle) >> 1);
    coarse[packed(c, key >> 3 * kBits)].add(points);
  }
  cells_ = std::move(coarse);
  width_ *= 2;
}

void PointCells::find_clusters(std::vector<Key>& keys, std::vector<std::uint32_t>& cluster) const {
  keys.clear();
  for (const auto& cell : cells_) keys.push_back(cell.first);
  std::ranges::sort(keys);
  DisjointSets sets(keys.size());
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    const auto c = coordinates(keys[i]);
    for (int n = 0; n < 13; ++n) {  // half of the 26 around it
      const std::array<std::int64_t, 3> other{c[0] + n / 9 - 1, c[1] + n / 3 % 3 - 1, c[2] + n % 3 - 1};
      if (std::ranges::any_of(other, [](std::int64_t x) { return x < 0 || x > kLast; })) continue;
      const auto found = std::ranges::lower_bound(keys, packed(other, keys[i] >> 3 * kBits));
      if (found != keys.end() && *found == packed(other, keys[i] >> 3 * kBits))
        sets.unite(i, static_cast<std::uint32_t>(found - keys.begin()));
    }
  }
  cluster.assign(keys.size(), kNone);
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    const std::uint32_t first = sets.find(i);  // not after i
    cluster[i] = first == i ? count++ : cluster[first];
  }
}

std::vector<CellPoints> PointCells::clusters() const {
  std::vector<Key> keys;
  std::vector<std::uint32_t> cluster;
  find_clusters(keys, cluster);
  std::vector<CellPoints> result;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (cluster[i] == result.size()) result.emplace_back();
    result[cluster[i]].add(cells_.at(keys[i]));
  }
  return result;
}

std::size_t PointCells::keep_below(std::uint64_t points) {
  std::vector<Key> keys;
  std::vector<std::uint32_t> cluster;
  find_clusters(keys, cluster);
  std::vector<std::uint64_t> sizes;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (cluster[i] == sizes.size()) sizes.push_back(0);
    sizes[cluster[i]] += cells_.at(keys[i]).points;
  }
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (sizes[cluster[i]] >= points) cells_.erase(keys[i]);
  return static_cast<std::size_t>(std::ranges::count_if(sizes, [&](auto size) { return size < points; }));
}

bool PointCells::contains(const Vec3& at, int side) const {
  return cells_.contains(key(at, side));
}

double PointCells::reach() const {
  return 2 * std::sqrt(3.0) * width_;  // the diagonal of two cells
}

}  // namespace sdm::io
