// Bands of faces that have a tolerance of their own, by the groups that they are of.
#pragma once

#include "io/image/pictures/color_scale.h"
#include "io/image/pictures/legend.h"
#include "map/places/place_limits.h"

#include <cstdint>
#include <optional>

namespace sdm::io {

/// The colours of the faces of a surface: bands of what the rows of PictureOptions::table accept that name
/// the face, besides PictureOptions::tolerance; those of one scale if there is no table.
class FaceScales {
 public:
  FaceScales(const ColorScale& scale, const PictureOptions& options);

  /// The colour of a distance on a face.
  [[nodiscard]] Rgb operator()(std::uint32_t face, double distance) const {
    return tolerances_ ? of_group(face, distance) : scale_(distance);
  }
  [[nodiscard]] bool by_group() const { return tolerances_.has_value(); }
  /// The scale of the legend: that of all faces, or in units of the limits of each, from -2 to 2.
  [[nodiscard]] ColorScale of_legend() const;
  /// Adapts the text of a legend to scales by group.
  void describe(LegendText& text) const;

 private:
  [[nodiscard]] Rgb of_group(std::uint32_t face, double distance) const;

  ColorScale scale_;
  std::optional<map::FaceTolerances> tolerances_;
};

}  // namespace sdm::io
