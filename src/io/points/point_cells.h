// Clusters of the points of a cloud, in memory that does not depend on their number.
#pragma once

#include <sdm/types.h>

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace sdm::io {

/// The box of most points of a cloud, by a sample of them: outliers may be far away.
class UsualBox {
 public:
  /// Each point with coordinates, in any order that is always the same.
  void add(const Vec3& point);
  /// The box without the outermost 0.5 % of the sample at each end of each axis; empty without points.
  [[nodiscard]] Box box() const;

 private:
  static constexpr std::size_t kMost = 1 << 14;
  std::vector<Vec3> sample_;  ///< one of each `stride_` points
  std::uint64_t stride_ = 1, count_ = 0;
};

/// What is known of the points of a cell, or of a cluster.
struct CellPoints {
  std::uint64_t points = 0;
  double distance = 0;  ///< the largest by the order that is asked for, and of which point
  double excess = 0;
  Vec3 point{};
  std::uint64_t number = kNone;
  std::uint32_t face = kNone;

  void add(const CellPoints& other);
};

/// Points in cubic cells. Points in cells that touch, at a corner at least, are of one *cluster*.
///
/// Cells are four times as wide as points would be apart if they were spread evenly over the faces of their
/// usual box, and at least 1/512 of its diagonal; twice as wide as often as more than 2^18 cells have points.
/// Neither depends on the order of the points.
class PointCells {
 public:
  PointCells(const Box& usual, std::uint64_t points);

  /// Adds one point or several; those on opposite sides of limits (`side`) are of separate clusters.
  void add(const Vec3& at, int side, const CellPoints& points);
  /// The clusters in the order of their cells. Cost: O(n log n) in cells.
  [[nodiscard]] std::vector<CellPoints> clusters() const;
  /// Forgets the clusters with at least so many points, so that contains() is of the others. Returns how
  /// many are left.
  std::size_t keep_below(std::uint64_t points);
  [[nodiscard]] bool contains(const Vec3& at, int side) const;
  /// The number of points in all cells.
  [[nodiscard]] std::uint64_t points() const;
  /// The width of a cell: points in separate clusters are at least so far apart.
  [[nodiscard]] double width() const;
  /// Points farther apart than this are in separate clusters unless others are between them.
  [[nodiscard]] double reach() const;

 private:
  struct Cell {
    int side = 0;
    std::array<std::int64_t, 3> at{};

    auto operator<=>(const Cell&) const = default;
  };
  struct CellHash {
    [[nodiscard]] std::size_t operator()(const Cell& cell) const;
  };

  [[nodiscard]] Cell cell(const Vec3& at, int side) const;
  /// Twice as wide.
  void coarsen();
  /// The cells in order, and the number of the cluster of each.
  void find_clusters(std::vector<Cell>& keys, std::vector<std::uint32_t>& cluster) const;

  Vec3 origin_;
  double finest_width_;
  int level_ = 0;  ///< how often the width was doubled
  std::unordered_map<Cell, CellPoints, CellHash> cells_;
};

}  // namespace sdm::io
