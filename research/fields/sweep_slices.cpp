#include "research/fields/sweep_slices.h"

#include <sdm/error.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "research/fields/draw_span.h"
#include "research/fields/drawn_sites.h"
#include "research/fields/slice_polygon.h"
#include "research/fields/slice_store.h"
#include "research/fields/tessellated_distance.h"

namespace sdm::fields {
namespace {

// What distinguishes the methods.
struct SweepRules {
  bool regions;  // sites are clipped by all walls of their region, not only by those that distances require
  bool bounds;   // the largest distance of a slice bounds that of the next
  bool retires;  // sites without influence on a slice are culled from later ones

  explicit SweepRules(Method method)
      : regions(method == Method::linear_factorization),
        bounds(method != Method::brute_force),
        retires(method != Method::brute_force) {}
};

// The part of a slice in which a site is drawn.
struct SlicePolygon {
  std::uint32_t site;  // its place among the active ones
  gl::ConvexPolygon drawn;
  bool may_retire = false;
  gl::ConvexPolygon tested;  // the larger part in which it is tested whether the site influences the slice
};

// Sites whose polygons are clipped by one thread.
struct Chunk {
  std::vector<SlicePolygon> polygons;
  std::uint64_t culled = 0, empty = 0;
};

// Sweeps a plane over the slices, from the lowest z up.
//
// Bounds: distances are 1-Lipschitz, so no distance in a slice exceeds the largest one of the slice before by
// more than dz. With the largest distance d, a site that is dz away from the slice is drawn within the radius
// √(d² − dz²) (SOM04).
//
// Retiring: the points closest to a site form a set V that contains, with x, the segment from x to its
// closest point of the site. So if a site lies below a slice that V does not meet, V does not meet any slice
// above. V does not meet the slice if, at every grid point g, the site is farther than the distance there by
// more than 2 r, where r is half a cell's diagonal: any x of the slice is within r of some g, and the
// difference of the two distances is 2-Lipschitz. It suffices to test the points within r of the site's
// polygon. The distance drawn for a face or edge, that of its plane or line, is a lower bound on that of the
// site. This requires that the segment crosses the slice inside the grid: only sites above whose box the grid
// extends are retired.
class SliceSweep {
 public:
  SliceSweep(const DrawingTask& task, Field& field, std::span<std::uint32_t> winners)
      : task_(task),
        field_(field),
        grid_(task.grid, task.sites.frame),
        method_(task.options.method),
        rules_(task, grid_),
        sites_(drawn_sites(task.sites)),
        store_(task, field, winners) {
    if (task.options.tessellation > 0)
      (void)TessellatedDistance(tessellation(), limit());  // throws before anything is drawn
    active_.resize(sites_.size());
    for (std::uint32_t i = 0; i < active_.size(); ++i) active_[i] = i;
  }

  void run() {
    double reach = method_.bounds ? first_bound() : rules_.limit;
    for (std::uint32_t k = 0; k < grid_.dims[2]; ++k) {
      const Progress& progress = task_.options.progress;
      if (progress && !progress("field", k / (grid_.dims[2] + 0.0))) throw Cancelled();
      const Slice slice(grid_, k);
      clip(slice, reach);
      draw(slice);
      const double largest = store(k);
      if (method_.retires) retire();
      if (method_.bounds) reach = std::min(rules_.limit, largest + grid_.step[2] + rules_.margin);
    }
    if (task_.options.progress && !task_.options.progress("field", 1)) throw Cancelled();
    field_.work.sites = sites_.size();
    field_.work.pairs = std::uint64_t{sites_.size()} * grid_.dims[2];
    field_.report.working_bytes = working_bytes();
  }

 private:
  // No point of a slice is farther from all points of the grid.
  [[nodiscard]] double radius() const { return 0.5 * std::hypot(grid_.step[0], grid_.step[1]); }

  static constexpr std::size_t kChunk = 256;  // sites
  static constexpr std::uint32_t kBand = 16;  // rows drawn by one thread

  // An upper bound on the distances in the first slice: to some of the sites.
  [[nodiscard]] double first_bound() const {
    constexpr std::size_t kTried = 256;
    double bound = rules_.limit;
    const Slice slice(grid_, 0);
    const double u = grid_.dims[0] - 1.0, v = grid_.dims[1] - 1.0;
    for (std::size_t i = 0; i < sites_.size(); i += 1 + sites_.size() / kTried) {
      double farthest = 0;
      for (const Vec2& corner : {Vec2{0, 0}, Vec2{u, 0}, Vec2{0, v}, Vec2{u, v}})
        farthest = std::max(farthest, norm(slice.point(corner) - sites_[i].region.corners[0]));
      bound = std::min(bound, farthest + rules_.margin);
    }
    return bound;
  }

  // Clips the active sites to the slice; no distance in it exceeds `reach`.
  void clip(const Slice& slice, double reach) {
    chunks_.resize((active_.size() + kChunk - 1) / kChunk);
    parallel_for(chunks_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) {
        Chunk& chunk = chunks_[c];
        chunk.polygons.clear();
        chunk.culled = chunk.empty = 0;
        for (std::size_t a = kChunk * c; a < std::min(active_.size(), kChunk * (c + 1)); ++a)
          clip(slice, reach, static_cast<std::uint32_t>(a), chunk);
      }
    });
    keep_.assign(active_.size(), 1);
    field_.work.pairs_culled += sites_.size() - active_.size();
    for (const Chunk& chunk : chunks_) {
      field_.work.pairs_culled += chunk.culled;
      field_.work.pairs_empty += chunk.empty;
      for (const SlicePolygon& p : chunk.polygons) keep_[p.site] = p.may_retire ? 0 : 1;
    }
  }

  void clip(const Slice& slice, double reach, std::uint32_t active, Chunk& chunk) const {
    const DrawnSite& site = sites_[active_[active]];
    const double gap = slice.gap(site);
    if (method_.bounds && gap > reach) {
      ++chunk.culled;
      return;
    }
    const int walls = method_.regions ? site.region.wall_count : site.region.strict_walls;
    const auto within = [&](double distance, double slack) {
      const double radius = std::sqrt(std::max(0.0, distance * distance - gap * gap)) + slack;
      return slice.clip(method_.bounds ? slice.around(site, radius) : slice.whole(), site.region, walls,
                        slack);
    };
    SlicePolygon polygon{active, within(reach, rules_.slack), method_.retires && may_retire(slice, site), {}};
    if (polygon.may_retire) polygon.tested = within(reach + radius(), rules_.slack + radius());
    if (polygon.drawn.empty()) ++chunk.empty;
    if (!polygon.drawn.empty() || polygon.may_retire) chunk.polygons.push_back(polygon);
  }

  [[nodiscard]] bool may_retire(const Slice& slice, const DrawnSite& site) const {
    if (!(site.box.upper[2] < slice.z())) return false;
    for (int k = 0; k < 2; ++k)
      if (site.box.lower[k] < grid_.at(k, 0) || site.box.upper[k] > grid_.at(k, grid_.dims[k] - 1))
        return false;
    return true;
  }

  void draw(const Slice& slice) {
    const std::uint32_t width = grid_.dims[0], height = grid_.dims[1];
    const auto squared_limit = static_cast<float>(limit() * limit());
    bands_.resize((height + kBand - 1) / kBand);
    std::atomic<std::uint64_t> evaluations{0};
    parallel_for(bands_.size(), 1, [&](std::size_t begin, std::size_t end) {
      thread_local PolygonRows rows;
      std::optional<TessellatedDistance> mesh;  // of distance functions
      if (task_.options.tessellation > 0) mesh.emplace(tessellation(), limit());
      for (std::size_t b = begin; b < end; ++b) {
        const auto first = static_cast<std::uint32_t>(kBand * b), last = std::min(first + kBand, height);
        DepthRows& band = bands_[b];
        band.reset(width, last - first, squared_limit);
        std::uint64_t count = 0;
        for (const Chunk& chunk : chunks_)
          for (const SlicePolygon& polygon : chunk.polygons) {
            const DrawnSite& site = sites_[active_[polygon.site]];
            rows.find(polygon.drawn, first, last, width);
            count += draw(slice, site, rows, first, mesh, band);
            if (polygon.may_retire && !kept(polygon.site)) {
              rows.find(polygon.tested, first, last, width);
              if (influences(slice, site, rows, first, band)) keep(polygon.site);
            }
          }
        evaluations += count;
      }
    });
    field_.work.evaluations += evaluations;
  }

  // The error of distance functions drawn as meshes, in the unit frame; 0: they are evaluated.
  [[nodiscard]] double tessellation() const { return task_.sites.frame.scale * task_.options.tessellation; }

  // No point whose distance is needed is drawn with a larger one.
  [[nodiscard]] double limit() const { return rules_.limit + tessellation(); }

  // Draws a site in the rows, by its `mesh` if there is one; returns the number of points.
  static std::uint64_t draw(const Slice& slice, const DrawnSite& site, const PolygonRows& rows,
                            std::uint32_t first_row, std::optional<TessellatedDistance>& mesh,
                            DepthRows& band) {
    std::uint64_t count = 0;
    for (std::uint32_t r = 0; r < rows.count(); ++r) {
      const auto [begin, end] = rows.points(r);
      if (begin == end) continue;
      const std::size_t at = (rows.first() + r - first_row) * band.stride + begin;
      const SpanVector vector = span_vector(slice, site, begin, rows.first() + r);
      float* squared = band.squared.data() + at;
      std::uint32_t* winner = band.winner.data() + at;
      if (mesh && site.region.type != SiteType::face)
        mesh->draw_span(squared, winner, end - begin, vector, site);
      else
        draw_span(squared, winner, end - begin, vector, site.code);
      count += end - begin;
    }
    return count;
  }

  [[nodiscard]] bool influences(const Slice& slice, const DrawnSite& site, const PolygonRows& rows,
                                std::uint32_t first_row, const DepthRows& band) const {
    const auto reach = static_cast<float>(2 * radius() + rules_.margin);
    for (std::uint32_t r = 0; r < rows.count(); ++r) {
      const auto [begin, end] = rows.points(r);
      const std::size_t at = (rows.first() + r - first_row) * band.stride + begin;
      if (comes_within(band.squared.data() + at, end - begin,
                       span_vector(slice, site, begin, rows.first() + r), reach))
        return true;
    }
    return false;
  }

  /// Returns the largest distance of the slice.
  double store(std::uint32_t k) {
    largest_.assign(bands_.size(), 0);
    parallel_for(bands_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        const auto first = static_cast<std::uint32_t>(kBand * b);
        for (std::uint32_t j = first; j < std::min(first + kBand, grid_.dims[1]); ++j)
          largest_[b] = std::max(largest_[b], store_.store(bands_[b], j - first, j, k));
      }
    });
    return std::sqrt(double{*std::max_element(largest_.begin(), largest_.end())});
  }

  void retire() {
    std::size_t kept = 0;
    for (std::size_t a = 0; a < active_.size(); ++a)
      if (keep_[a] != 0) active_[kept++] = active_[a];
    active_.resize(kept);
  }

  // Set by the threads of several bands.
  [[nodiscard]] bool kept(std::uint32_t active) {
    return std::atomic_ref(keep_[active]).load(std::memory_order_relaxed) != 0;
  }
  void keep(std::uint32_t active) { std::atomic_ref(keep_[active]).store(1, std::memory_order_relaxed); }

  [[nodiscard]] std::size_t working_bytes() const {
    std::size_t bytes =
        sites_.capacity() * sizeof(DrawnSite) + active_.capacity() * sizeof(std::uint32_t) + keep_.capacity();
    for (const Chunk& chunk : chunks_) bytes += chunk.polygons.capacity() * sizeof(SlicePolygon);
    for (const DepthRows& band : bands_) bytes += band.bytes();
    return bytes;
  }

  const DrawingTask& task_;
  Field& field_;
  const UnitGrid grid_;
  const SweepRules method_;
  const SliceRules rules_;
  const std::vector<DrawnSite> sites_;
  const SliceStore store_;
  std::vector<std::uint32_t> active_;  // sites that are not retired, in order
  std::vector<std::uint8_t> keep_;     // of each of them: it may influence slices above
  std::vector<Chunk> chunks_;
  std::vector<DepthRows> bands_;
  std::vector<float> largest_;  // squared distance of each band
};

}  // namespace

void sweep_slices(const DrawingTask& task, Field& field, std::span<std::uint32_t> winners) {
  SliceSweep(task, field, winners).run();
}

}  // namespace sdm::fields
