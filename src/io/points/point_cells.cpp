#include "io/points/point_cells.h"

#include <algorithm>
#include <cmath>

#include "core/disjoint_sets.h"
#include "geometry/vec.h"

namespace sdm::io {
namespace {

constexpr std::size_t kMostCells = std::size_t{1} << 18;

// The coordinate of a cell at the finest level: floor(x), within ±2^62, as a number that does not depend on
// the level. Only coordinates whose doubles are farther apart than cells are that large.
std::int64_t finest(double x) {
  constexpr double kFarthest = 0x1p62;
  return static_cast<std::int64_t>(std::floor(std::clamp(x, -kFarthest, kFarthest)));
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
    box.lower[k] = along[outside];
    box.upper[k] = along[along.size() - 1 - outside];
  }
  return box;
}

void CellPoints::add(const CellPoints& other) {
  const std::uint64_t all = points + other.points;
  if (points == 0 || other.excess > excess || (other.excess == excess && other.number < number))
    *this = other;
  points = all;
}

std::size_t PointCells::CellHash::operator()(const Cell& cell) const {
  std::uint64_t hash = static_cast<std::uint64_t>(cell.side);
  for (const std::int64_t x : cell.at) {
    hash = (hash ^ static_cast<std::uint64_t>(x)) * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 32;
  }
  return static_cast<std::size_t>(hash);
}

PointCells::PointCells(const Box& usual, std::uint64_t points) : origin_(usual.lower) {
  constexpr double kFinest = 1.0 / 512, kSpacings = 4;
  const double apart = kSpacings / std::sqrt(static_cast<double>(std::max<std::uint64_t>(points, 1)));
  const double width = diagonal(usual) * std::max(kFinest, apart);
  finest_width_ = width > 0 && std::isfinite(width) ? width : 1;
  if (!finite(origin_)) origin_ = {};
}

PointCells::Cell PointCells::cell(const Vec3& at, int side) const {
  Cell result{side, {}};
  for (int k = 0; k < 3; ++k) result.at[k] = finest((at[k] - origin_[k]) / finest_width_) >> level_;
  return result;
}

void PointCells::add(const Vec3& at, int side, const CellPoints& points) {
  cells_[cell(at, side)].add(points);
  while (cells_.size() > kMostCells) coarsen();
}

// The level is the first at which all cells fit, whatever the order of the points. It is below 63: there, all
// coordinates are -1, 0 or 1.
void PointCells::coarsen() {
  std::unordered_map<Cell, CellPoints, CellHash> coarse;
  for (const auto& [fine, points] : cells_) {
    Cell cell = fine;
    for (std::int64_t& x : cell.at) x >>= 1;  // rounds down, as the cells of all levels have the same origin
    coarse[cell].add(points);
  }
  cells_ = std::move(coarse);
  ++level_;
}

void PointCells::find_clusters(std::vector<Cell>& keys, std::vector<std::uint32_t>& cluster) const {
  keys.clear();
  for (const auto& cell : cells_) keys.push_back(cell.first);
  std::ranges::sort(keys);
  DisjointSets sets(keys.size());
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    for (int n = 0; n < 13; ++n) {  // half of the 26 around it
      Cell other = keys[i];
      other.at[0] += n / 9 - 1;
      other.at[1] += n / 3 % 3 - 1;
      other.at[2] += n % 3 - 1;
      const auto found = std::ranges::lower_bound(keys, other);
      if (found != keys.end() && *found == other)
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
  std::vector<Cell> keys;
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
  std::vector<Cell> keys;
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
  return cells_.contains(cell(at, side));
}

std::uint64_t PointCells::points() const {
  std::uint64_t sum = 0;
  for (const auto& cell : cells_) sum += cell.second.points;
  return sum;
}

double PointCells::width() const {
  return std::ldexp(finest_width_, level_);
}

double PointCells::reach() const {
  return 2 * std::sqrt(3.0) * width();  // the diagonal of two cells
}

}  // namespace sdm::io
