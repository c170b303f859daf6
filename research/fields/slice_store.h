// Drawing sites in slices, and storing drawn slices in a field.
#pragma once

#include <cmath>

#include "research/fields/draw_span.h"
#include "research/fields/drawing_task.h"
#include "research/fields/drawn_sites.h"
#include "research/fields/slice_polygon.h"
#include "volume/field_writer.h"

namespace sdm::fields {

/// The distance vector of a site, linear along a row (Lemma 1), from point (i, j) of a slice on.
inline SpanVector span_vector(const Slice& slice, const DrawnSite& site, std::uint32_t i, std::uint32_t j) {
  const Vec2 start{i + 0.0, j + 0.0};
  return {site.region.distance_vector(slice.point(start)), site.region.change(slice.step_along_row())};
}

/// Where the slice methods store what they have drawn: distances without a sign, and winners where they are
/// needed for signs or sites.
class SliceStore {
 public:
  /// `winners`: one per point of the grid, or none.
  SliceStore(const DrawingTask& task, DistanceField& field, std::span<std::uint32_t> winners)
      : grid_(task.grid),
        band_(task.options.max_distance),
        unit_(1 / task.sites.frame.scale),
        writer_(field),
        winners_(winners) {}

  /// Stores row j of slice k, drawn in row `row` of `rows`. Returns the largest squared distance, infinity if
  /// there is a point without a winner.
  float store(const DepthRows& rows, std::size_t row, std::uint32_t j, std::uint32_t k) const {
    const float* squared = rows.squared.data() + row * rows.stride;
    const std::uint32_t* winner = rows.winner.data() + row * rows.stride;
    const std::size_t index = grid_.index(0, j, k);
    float most = 0;
    for (std::uint32_t i = 0; i < grid_.dims[0]; ++i) {
      if (winner[i] == kNone) {
        most = std::numeric_limits<float>::infinity();
        continue;
      }
      most = std::max(most, squared[i]);
      const double d = unit_ * std::sqrt(double{squared[i]});
      if (d > band_) continue;
      writer_.distance(index + i, static_cast<float>(d));
      if (!winners_.empty()) winners_[index + i] = winner[i];
    }
    return most;
  }

 private:
  const Grid& grid_;
  double band_, unit_;  // unit_: of the unit frame
  volume::FieldWriter writer_;
  std::span<std::uint32_t> winners_;
};

}  // namespace sdm::fields
