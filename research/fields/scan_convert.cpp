#include "research/fields/scan_convert.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/parallel.h"
#include "research/fields/draw_span.h"
#include "research/fields/drawn_sites.h"
#include "research/fields/slice_polygon.h"
#include "research/fields/slice_store.h"

namespace sdm::fields {
namespace {

constexpr std::uint32_t kSlab = 8;  // slices scan converted by one thread, site by site

// The slices that the polyhedron of a site may meet.
struct SliceRange {
  std::uint32_t begin, end;
};

class ScanConversion {
 public:
  ScanConversion(const DrawingTask& task, Field& field, std::span<std::uint32_t> winners)
      : task_(task),
        field_(field),
        grid_(task.grid, task.sites.frame),
        rules_(task, grid_),
        sites_(drawn_sites(task.sites)),
        store_(task, field, winners) {}

  void run() {
    assign_slabs();
    const std::size_t slabs = slab_starts_.size() - 1;
    std::atomic<std::uint64_t> drawn{0}, empty{0}, evaluations{0};
    std::atomic<std::size_t> largest{0};
    parallel_for(slabs, 1, task_.options.progress, "field", [&](std::size_t begin, std::size_t end) {
      thread_local DepthRows rows;
      for (std::size_t slab = begin; slab < end; ++slab) {
        Counts counts;
        convert(static_cast<std::uint32_t>(slab), rows, counts);
        drawn += counts.pairs;
        empty += counts.empty;
        evaluations += counts.evaluations;
      }
      for (std::size_t seen = largest;
           seen < rows.bytes() && !largest.compare_exchange_weak(seen, rows.bytes());) {
      }
    });
    Work& work = field_.work;
    work.sites = sites_.size();
    work.pairs = std::uint64_t{sites_.size()} * grid_.dims[2];
    work.pairs_culled = work.pairs - drawn;
    work.pairs_empty = empty;
    work.evaluations = evaluations;
    field_.report.working_bytes = sites_.capacity() * sizeof(DrawnSite) +
                                  slab_sites_.capacity() * sizeof(std::uint32_t) +
                                  slab_starts_.capacity() * sizeof(std::size_t) + thread_count() * largest;
  }

 private:
  struct Counts {
    std::uint64_t pairs = 0, empty = 0, evaluations = 0;
  };

  [[nodiscard]] SliceRange slices_of(const DrawnSite& site) const {
    const double first = std::ceil((site.box.lower[2] - rules_.limit - grid_.origin[2]) / grid_.step[2]);
    const double last = std::floor((site.box.upper[2] + rules_.limit - grid_.origin[2]) / grid_.step[2]);
    const double begin = std::max(first, 0.0), end = std::min(last + 1, grid_.dims[2] + 0.0);
    if (!(begin < end)) return {0, 0};
    return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
  }

  // Sorts the sites by the slabs that their polyhedra meet; within a slab, they stay in order.
  void assign_slabs() {
    const std::size_t slabs = (grid_.dims[2] + kSlab - 1) / kSlab;
    slab_starts_.assign(slabs + 1, 0);
    const auto for_slabs = [&](std::uint32_t site, auto&& visit) {
      const SliceRange range = slices_of(sites_[site]);
      for (std::uint32_t s = range.begin / kSlab; s < (range.end + kSlab - 1) / kSlab; ++s) visit(s);
    };
    for (std::uint32_t i = 0; i < sites_.size(); ++i)
      for_slabs(i, [&](std::uint32_t slab) { ++slab_starts_[slab + 1]; });
    for (std::size_t s = 0; s < slabs; ++s) slab_starts_[s + 1] += slab_starts_[s];
    slab_sites_.resize(slab_starts_.back());
    std::vector<std::size_t> next(slab_starts_.begin(), slab_starts_.end() - 1);
    for (std::uint32_t i = 0; i < sites_.size(); ++i)
      for_slabs(i, [&](std::uint32_t slab) { slab_sites_[next[slab]++] = i; });
  }

  void convert(std::uint32_t slab, DepthRows& rows, Counts& counts) const {
    const std::uint32_t begin = kSlab * slab, end = std::min(begin + kSlab, grid_.dims[2]),
                        height = grid_.dims[1];
    rows.reset(grid_.dims[0], std::size_t{height} * (end - begin),
               static_cast<float>(rules_.limit * rules_.limit));
    for (std::size_t s = slab_starts_[slab]; s < slab_starts_[slab + 1]; ++s) {
      const DrawnSite& site = sites_[slab_sites_[s]];
      const SliceRange range = slices_of(site);
      for (std::uint32_t k = std::max(begin, range.begin); k < std::min(end, range.end); ++k) {
        ++counts.pairs;
        convert(Slice(grid_, k), site, std::size_t{height} * (k - begin), rows, counts);
      }
    }
    for (std::uint32_t k = begin; k < end; ++k)
      for (std::uint32_t j = 0; j < height; ++j)
        store_.store(rows, std::size_t{height} * (k - begin) + j, j, k);
  }

  // The slice of a polyhedron: the region, within the maximum distance.
  void convert(const Slice& slice, const DrawnSite& site, std::size_t first_row, DepthRows& rows,
               Counts& counts) const {
    thread_local PolygonRows polygon_rows;
    const double gap = slice.gap(site);
    const double radius = std::sqrt(std::max(0.0, rules_.limit * rules_.limit - gap * gap));
    gl::ConvexPolygon polygon =
        slice.clip(slice.around(site, radius), site.region, site.region.wall_count, rules_.slack);
    if (site.region.type == SiteType::face) slice.clip_by_plane_distance(polygon, site.region, rules_.limit);
    if (polygon.empty()) {
      ++counts.empty;
      return;
    }
    polygon_rows.find(polygon, 0, grid_.dims[1], grid_.dims[0]);
    for (std::uint32_t r = 0; r < polygon_rows.count(); ++r) {
      const auto [begin, end] = polygon_rows.points(r);
      if (begin == end) continue;
      const std::uint32_t j = polygon_rows.first() + r;
      const std::size_t at = (first_row + j) * rows.stride + begin;
      draw_span(rows.squared.data() + at, rows.winner.data() + at, end - begin,
                span_vector(slice, site, begin, j), site.code);
      counts.evaluations += end - begin;
    }
  }

  const DrawingTask& task_;
  Field& field_;
  const UnitGrid grid_;
  const SliceRules rules_;
  const std::vector<DrawnSite> sites_;
  const SliceStore store_;
  std::vector<std::size_t> slab_starts_;  // of each slab, its first site in:
  std::vector<std::uint32_t> slab_sites_;
};

}  // namespace

void scan_convert(const DrawingTask& task, Field& field, std::span<std::uint32_t> winners) {
  ScanConversion(task, field, winners).run();
}

}  // namespace sdm::fields
