#include <sdm/closest_points.h>
#include <sdm/doubts.h>
#include <sdm/error.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/triangle.h"
#include "geometry/vec.h"

namespace sdm {
namespace {

double area_of_piece(const Corners& t) {
  return 0.5 * norm(cross(t[1] - t[0], t[2] - t[0]));
}

struct CoveredPiece {
  Corners at;
  double area;
  std::uint32_t face;
  bool whole = true;    // the face, undivided
  bool within = false;  // its centroid is within reach
};

/// The distances of points to what was measured; those above twice the reach may be rounded down to that.
using Distances = std::function<std::vector<double>(std::span<const Vec3> points)>;

/// Points in the cells of a grid, for those within a length of a query.
class PointGrid {
 public:
  PointGrid(std::span<const Vec3> points, double length) : length_(length) {
    cells_.reserve(points.size());
    for (const Vec3& p : points) {
      if (!finite(p)) throw Error("a measured point has a coordinate that is NaN or infinite");
      cells_.push_back({cell_of(p), p});
    }
    std::ranges::sort(cells_, {}, &Entry::cell);
  }

  /// The distance of the nearest point, or the length if there is none within it.
  [[nodiscard]] double operator()(const Vec3& p) const {
    const Cell centre = cell_of(p);
    double least = length_ * length_;
    for (double x = -1; x <= 1; ++x)
      for (double y = -1; y <= 1; ++y) {
        const Cell first{centre[0] + x, centre[1] + y, centre[2] - 1},
            last{centre[0] + x, centre[1] + y, centre[2] + 1};
        for (auto at = std::ranges::lower_bound(cells_, first, {}, &Entry::cell);
             at != cells_.end() && at->cell <= last; ++at)
          least = std::min(least, squared_norm(at->point - p));
      }
    return std::sqrt(least);
  }

 private:
  using Cell = std::array<double, 3>;  // whole numbers
  struct Entry {
    Cell cell;
    Vec3 point;
  };

  [[nodiscard]] Cell cell_of(const Vec3& p) const {
    return {std::floor(p[0] / length_), std::floor(p[1] / length_), std::floor(p[2] / length_)};
  }

  double length_;
  std::vector<Entry> cells_;
};

class CoverageSearch {
 public:
  /// `accuracy`: the error of a distance.
  CoverageSearch(const Mesh& o2, Distances distances, double accuracy, double reach,
                 const CoverageOptions& options)
      : distances_(std::move(distances)), options_(options), reach_(reach), accuracy_(accuracy) {
    for (std::size_t f = 0; f < o2.triangles.size(); ++f) {
      const Corners at = corners_of(o2, f);
      const double area = area_of_piece(at);
      if (area > 0) {
        pieces_.push_back({at, area, static_cast<std::uint32_t>(f)});
        total_ += area;
      }
    }
  }

  /// Also fills the places of `map`, unless null.
  Coverage operator()(CoverageMap* map = nullptr) {
    map_ = map;
    std::size_t count = 0;
    double guessed = 0, open = total_;
    while (true) {
      count += pieces_.size();
      std::tie(guessed, open) = measure();
      const double progress = 1 - open / total_;
      if (options_.progress && !options_.progress("coverage", progress)) throw Cancelled();
      if (open <= options_.precision * total_ || count + 4 * pieces_.size() > options_.most_pieces) break;
      divide();
    }
    for (const CoveredPiece& p : pieces_) record(p, p.within);
    const double lower = covered_ / total_;
    return {std::clamp((covered_ + guessed) / total_, 0.0, 1.0), lower, std::min(1.0, lower + open / total_),
            reach_};
  }

 private:
  /// Settles what the centroids decide and keeps the other pieces. Returns the area of those whose centroids
  /// are within reach, and of all of them.
  std::pair<double, double> measure() {
    std::vector<Vec3> centroids;
    centroids.reserve(pieces_.size());
    for (const CoveredPiece& p : pieces_) centroids.push_back((1.0 / 3) * (p.at[0] + p.at[1] + p.at[2]));
    const std::vector<double> distances = distances_(centroids);
    std::vector<CoveredPiece> open;
    double guessed = 0, area = 0;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const double d = distances[i];
      double radius = accuracy_;
      for (const Vec3& corner : pieces_[i].at)
        radius = std::max(radius, norm(corner - centroids[i]) + accuracy_);
      if (d + radius <= reach_) {
        covered_ += pieces_[i].area;
        record(pieces_[i], true);
      } else if (d - radius <= reach_) {
        pieces_[i].within = d <= reach_;
        open.push_back(pieces_[i]);
        area += pieces_[i].area;
        if (d <= reach_) guessed += pieces_[i].area;
      } else {
        record(pieces_[i], false);
      }
    }
    pieces_ = std::move(open);
    return {guessed, area};
  }

  void divide() {
    std::vector<CoveredPiece> quarters;
    quarters.reserve(4 * pieces_.size());
    for (const CoveredPiece& p : pieces_) {
      const Corners& at = p.at;
      const Corners middle{0.5 * (at[0] + at[1]), 0.5 * (at[1] + at[2]), 0.5 * (at[2] + at[0])};
      for (const Corners& corners :
           {Corners{at[0], middle[0], middle[2]}, Corners{middle[0], at[1], middle[1]},
            Corners{middle[2], middle[1], at[2]}, middle})
        quarters.push_back({corners, 0.25 * p.area, p.face, false});
    }
    pieces_ = std::move(quarters);
  }

  void record(const CoveredPiece& piece, bool covered) {
    if (!map_) return;
    if (piece.whole)
      map_->of_face[piece.face] = covered ? 1 : 0;
    else
      map_->pieces.push_back({piece.face, piece.at, covered});
  }

  Distances distances_;
  const CoverageOptions& options_;
  double reach_, accuracy_, total_ = 0, covered_ = 0;
  std::vector<CoveredPiece> pieces_;
  CoverageMap* map_ = nullptr;
};

/// Sorts the pieces by face and sums them up; those of a face that all agree are the face.
void sum_up_pieces(CoverageMap& map) {
  std::ranges::stable_sort(map.pieces, {}, &CoveragePiece::face);
  std::vector<CoveragePiece> mixed;
  for (auto begin = map.pieces.begin(); begin != map.pieces.end();) {
    const auto end =
        std::find_if(begin, map.pieces.end(), [&](const CoveragePiece& p) { return p.face != begin->face; });
    double area = 0, covered = 0;
    bool all = true, none = true;
    for (auto p = begin; p != end; ++p) {
      area += area_of_piece(p->corners);
      if (p->covered) covered += area_of_piece(p->corners);
      (p->covered ? none : all) = false;
    }
    if (!all && !none) mixed.insert(mixed.end(), begin, end);
    map.of_face[begin->face] = all ? 1.F : none ? 0.F : static_cast<float>(covered / area);
    begin = end;
  }
  map.pieces = std::move(mixed);
}

CoverageMap mapped(const Mesh& o2, CoverageSearch search) {
  CoverageMap map;
  map.of_face.assign(o2.triangles.size(), std::numeric_limits<float>::quiet_NaN());
  static_cast<Coverage&>(map) = search(&map);
  sum_up_pieces(map);
  return map;
}

void check_coverage(const Mesh& o2, double reach, const CoverageOptions& options) {
  if (!(reach > 0)) throw Error("the reach of a coverage must be greater than 0");
  if (!(options.precision >= 0)) throw Error("the precision of a coverage must be at least 0");
  validate(o2);
}

CoverageSearch search_of(const Mesh& o2, const Sites& measured, double reach,
                         const CoverageOptions& options) {
  check_coverage(o2, reach, options);
  const auto distances = [&measured](std::span<const Vec3> points) {
    std::vector<double> result;
    result.reserve(points.size());
    for (const ClosestPoint& c : closest_points(measured, points)) result.push_back(c.distance);
    return result;
  };
  const double accuracy = engine_accuracy(engines().front(), o2, measured.mesh());
  return {o2, distances, accuracy, reach, options};
}

CoverageSearch search_of(const Mesh& o2, std::span<const Vec3> measured, double reach,
                         const CoverageOptions& options) {
  check_coverage(o2, reach, options);
  if (measured.empty()) throw Error("a coverage needs measured points");
  const auto grid = std::make_shared<const PointGrid>(measured, 2 * reach);
  const auto distances = [grid](std::span<const Vec3> points) {
    std::vector<double> result(points.size());
    parallel_for(points.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) result[i] = (*grid)(points[i]);
    });
    return result;
  };
  return {o2, distances, 0, reach, options};
}

template <class Measured>
Coverage coverage_of(const Mesh& o2, const Measured& measured, double reach,
                     const CoverageOptions& options) try {
  return search_of(o2, measured, reach, options)();
} catch (const std::bad_alloc&) {
  throw out_of_memory("the coverage");
}

template <class Measured>
CoverageMap coverage_map_of(const Mesh& o2, const Measured& measured, double reach,
                            const CoverageOptions& options) try {
  return mapped(o2, search_of(o2, measured, reach, options));
} catch (const std::bad_alloc&) {
  throw out_of_memory("the coverage");
}

}  // namespace

Coverage coverage(const Mesh& o2, const Sites& measured, double reach, const CoverageOptions& options) {
  return coverage_of(o2, measured, reach, options);
}

Coverage coverage(const Mesh& o2, std::span<const Vec3> measured, double reach,
                  const CoverageOptions& options) {
  return coverage_of(o2, measured, reach, options);
}

CoverageMap coverage_map(const Mesh& o2, const Sites& measured, double reach,
                         const CoverageOptions& options) {
  return coverage_map_of(o2, measured, reach, options);
}

CoverageMap coverage_map(const Mesh& o2, std::span<const Vec3> measured, double reach,
                         const CoverageOptions& options) {
  return coverage_map_of(o2, measured, reach, options);
}

}  // namespace sdm
