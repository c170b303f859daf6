#include "io/image/pictures/face_scales.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sdm::io {
namespace {

/// The scale with these limits.
ColorScale banded(ColorScale scale, const Tolerance& t) {
  const auto [lo, hi] = std::pair(scale.lower, scale.upper);
  scale.lower = rules::banded_lo(t.lower, t.upper, lo, hi);
  scale.upper = rules::banded_hi(t.lower, t.upper, lo, hi);
  scale.tolerance = t;
  return scale;
}

}  // namespace

FaceScales::FaceScales(const ColorScale& scale, const PictureOptions& options) : scale_(scale) {
  if (!options.table.empty() && !options.names.empty())
    tolerances_.emplace(options.tolerance, options.names, options.table);
  // A table of groups of another mesh changes nothing.
  const auto names_none = [](const NamedFaces& named) { return named.faces.empty(); };
  if (std::ranges::all_of(faces_of_groups(options.names, options.table), names_none)) tolerances_.reset();
}

Rgb FaceScales::of_group(std::uint32_t face, double distance) const {
  if (!std::isfinite(distance)) return kNoValue;
  return banded(scale_, tolerances_->of(face))(distance);
}

ColorScale FaceScales::of_legend() const {
  if (!tolerances_) return scale_;
  ColorScale relative = banded(scale_, Tolerance(-1, 1));
  relative.accuracy = 0;
  return relative;
}

void FaceScales::describe(LegendText& text) const {
  if (!tolerances_) return;
  text.subtitle = "by the limits of each group";
  text.labels = {{-1, "lower limit", true}, {1, "upper limit", true}};
  std::erase_if(text.notes, [](const std::string& note) { return note.starts_with("beyond"); });
  text.notes.insert(text.notes.end(),
                    {"green: within its limits", "darker: nearer a limit", "beige: without limits"});
}

}  // namespace sdm::io
