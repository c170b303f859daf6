#include "atlas/packing/fit.h"

#include <sdm/error.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <string>

#include "atlas/packing/footprint.h"
#include "core/memory.h"

namespace sdm::atlas {
namespace {

// Rows are added in strips of an eighth of the resolution, so that a sequence of small edits rarely adds any.
std::uint32_t whole_strips(std::uint32_t rows, std::uint32_t resolution) {
  const std::uint32_t strip = std::max(16u, resolution / 8);
  return (rows + strip - 1) / strip * strip;
}

struct Fitted {
  std::vector<Placement> placements;
  std::uint32_t rows = 0;  ///< that charts use
};

class Fitter {
 public:
  Fitter(std::span<const Shape> shapes, double scale, const Room& room) : scale_(scale), room_(room) {
    const double width = room.resolution(), margin = 2.0 * room.gutter() + 2;
    footprints_.reserve(shapes.size());
    for (const Shape& shape : shapes) {
      const auto [less, more] = std::minmax({scale * shape.size[0] + margin, scale * shape.size[1] + margin});
      if (!(less <= width && more <= kMaxRows))
        throw Error("a chart of the added faces takes " + std::to_string(static_cast<std::uint64_t>(less)) +
                    " × " + std::to_string(static_cast<std::uint64_t>(more)) +
                    " texels at the scale of the atlas, more than fit into its width of " +
                    std::to_string(room.resolution()) + "; lay out the edited mesh anew");
      footprints_.push_back(make_footprint(shape, {scale, room.gutter(), 1}));
      for (const Stamp& stamp : footprints_.back().stamps)
        for (const Run& run : stamp.runs) {
          longest_ = std::max(longest_, run.length);
          texels_ += run.length;
        }
    }
    texels_ /= 4;  // turns
    order_.resize(shapes.size());
    std::iota(order_.begin(), order_.end(), 0u);
    const auto extent = [&](std::uint32_t s) { return shapes[s].size[0] * shapes[s].size[1]; };
    std::ranges::stable_sort(order_, [&](auto a, auto b) { return extent(a) > extent(b); });
  }

  [[nodiscard]] std::optional<Fitted> fit(std::uint32_t more_rows) const {
    BitmapBin bin = room_.bin(more_rows, longest_);
    Fitted fitted{std::vector<Placement>(footprints_.size()), room_.rows()};
    for (const std::uint32_t s : order_) {
      const Footprint& footprint = footprints_[s];
      const auto best = lowest_turn(
          footprint, room_.rows() + more_rows,
          [&](const Stamp& stamp, std::uint32_t end_y) { return bin.first_fit(stamp, 0, end_y); });
      if (!best) return std::nullopt;
      bin.place(footprint.stamps[best->turn], best->spot);
      fitted.placements[s] =
          placement_of(footprint, best->turn, scale_, {1.0 * best->spot.x, 1.0 * best->spot.y});
      fitted.rows = std::max(fitted.rows, best->bottom);
    }
    return fitted;
  }

  /// Texels that all shapes take, gutters included.
  [[nodiscard]] std::uint64_t texels() const { return texels_; }

 private:
  double scale_;
  const Room& room_;
  std::vector<Footprint> footprints_;
  std::vector<std::uint32_t> order_;  ///< of placement
  std::uint32_t longest_ = 1;         ///< run
  std::uint64_t texels_ = 0;
};

}  // namespace

std::vector<Placement> fit(std::span<const Shape> shapes, double scale, Room& room) {
  const Fitter fitter(shapes, scale, room);
  const std::uint32_t n = room.resolution(), most = kMaxRows - room.rows();
  // Adds no rows at first; then about as many as are needed, and twice as many whenever these do not
  // suffice.
  const auto needed = static_cast<std::uint32_t>(std::min<std::uint64_t>(most, 2 * fitter.texels() / n + 1));
  std::uint32_t more = 0;
  for (;;) {
    if (const auto fitted = fitter.fit(more)) {
      const std::uint32_t added = whole_strips(fitted->rows - room.rows(), n);
      room.grow(std::min(kMaxRows, room.rows() + added));
      return fitted->placements;
    }
    if (more == most)
      throw Error("the added faces do not fit into an atlas of " + std::to_string(kMaxRows) +
                  " rows; lay out the edited mesh anew");
    more = std::min(most, more == 0 ? whole_strips(needed, n) : 2 * more);
    require_memory(BitmapBin::bytes(n, room.rows() + more), "packing the atlas");
  }
}

}  // namespace sdm::atlas
