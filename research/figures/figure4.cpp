// Figure 4: a triangle that is scaled and sheared, with its samples.
#include <fmt/format.h>
#include <sdm/sampling_bound.h>

#include <algorithm>
#include <array>

#include "research/figures/affine_map.h"
#include "research/figures/charts/face_drawing.h"
#include "research/figures/figures.h"
#include "research/figures/pieces.h"
#include "research/figures/sampling.h"

namespace sdm::figures {
namespace {

const std::array<Vec3, 3> kRest{{{0, 0, 0}, {1, 0, 0}, {0.35, 0.8, 0}}};

/// S: scale (1.25, 0.8), then a shear of 0.6 along x.
Vec3 deformed(const Vec3& p) {
  const double x = 1.25 * p[0], y = 0.8 * p[1];
  return {x + 0.6 * y, y, 0};
}

}  // namespace

Figure figure4(Run&) {
  Surface surface(Mesh{{kRest[0], kRest[1], kRest[2]}, {{0, 1, 2}}, {}}, {.resolution = 16});
  SamplingBound bound(surface);
  const std::string rest = faces_with_samples("T at rest", surface, 260),
                    atlas = atlas_with_samples("t in the atlas, unchanged", surface, 18);
  const AffineMap m1 = affine_map(surface, 0);
  const double bound1 = bound.value(), gap1 = measured_gap(surface, 200);
  const std::vector<Vec3> before = surface.sample_points();

  surface.refit(std::array{deformed(kRest[0]), deformed(kRest[1]), deformed(kRest[2])});
  bound.refit(surface);
  const std::string after = faces_with_samples("T after the deformation S", surface, 260);
  const AffineMap m2 = affine_map(surface, 0);
  const double bound2 = bound.value(), gap2 = measured_gap(surface, 200);
  const std::vector<Vec3> samples = surface.sample_points();
  double moved_wrongly = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    moved_wrongly = std::max(moved_wrongly, norm(samples[i] - deformed(before[i])));

  Figure figure{
      .key = "figure4",
      .title = "Figure 4: distance map of a deforming triangle",
      .paper =
          "A triangle undergoes a non-rigid deformation S of shear and scale; a new affine map M2 is "
          "computed for it. Dots are the samples, in the 2D domain and on the triangle.",
      .measured = fmt::format(
          "S scales by (1.25, 0.8) and shears by 0.6. The samples keep their texels and move affinely with "
          "the triangle, up to {:.0e} m. The covering radius of the {} samples grows from {:.4f} to {:.4f} m "
          "by `SamplingBound`; the largest distance to a nearest sample found on the triangle is {:.4f} and "
          "{:.4f} m.",
          moved_wrongly, samples.size(), bound1, bound2, gap1, gap2)};
  figure.html = {row({panel(rest, ""), panel(atlas, ""), panel(after, "")}),
                 table({"map", "s_x (texels/m)", "s_y (texels/m)", "shear s_h"},
                       {{"M1, at rest", fmt::format("{:.4f}", m1.sx), fmt::format("{:.4f}", m1.sy),
                         fmt::format("{:.4f}", m1.sh)},
                        {"M2, deformed", fmt::format("{:.4f}", m2.sx), fmt::format("{:.4f}", m2.sy),
                         fmt::format("{:.4f}", m2.sh)}})};
  figure.json = {{"paper", Json::object()},
                 {"measured",
                  {{"samples", samples.size()},
                   {"maps", {{m1.sx, m1.sy, m1.sh}, {m2.sx, m2.sy, m2.sh}}},
                   {"largest_deviation_of_a_sample", moved_wrongly},
                   {"bound", {bound1, bound2}},
                   {"measured_gap", {gap1, gap2}}}}};
  return figure;
}

}  // namespace sdm::figures
