#include <sdm/unit_check.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/vec.h"
#include "registration/samples.h"

namespace sdm {
namespace {

constexpr std::size_t kUnitSamples = 1024;

double misfit_of(const Alignment& alignment) {
  return alignment.gyration_radius > 0 ? alignment.after.rms / alignment.gyration_radius : 0;
}

std::optional<OtherUnit> best_unit(const registration::Samples& samples, const Sites& o2,
                                   const Alignment& found, AlignOptions options) {
  constexpr double kFits = 0.02, kMuchBetter = 0.25, kAcceptable = 0.1;
  constexpr double kTooLarge = 2;  // times the size of O2: most of O1 would be far from it
  const double as_given = misfit_of(found);
  if (!(as_given > kFits)) return std::nullopt;
  OtherUnit best{.misfit = std::min(kMuchBetter * as_given, kAcceptable), .misfit_as_given = as_given};
  Box box;
  for (const Vec3& p : samples.points) extend(box, p);
  const double size = diagonal(box), most = kTooLarge * diagonal(bounds(o2.mesh()));
  options.samples = kUnitSamples;
  for (const double ratio : {10.0, 25.4, 304.8, 1000.0})
    for (const double factor : {ratio, 1 / ratio}) {
      if (!(factor * size <= most)) continue;
      std::vector<Vec3> scaled = samples.points;
      for (Vec3& p : scaled) p = factor * p;
      const double misfit = misfit_of(align(scaled, samples.normals, o2, options));
      if (misfit < best.misfit) best.factor = factor, best.misfit = misfit;
    }
  return best.factor != 1 ? std::optional(best) : std::nullopt;
}

}  // namespace

std::optional<OtherUnit> find_other_unit(const Mesh& o1, const Sites& o2, const Alignment& found,
                                         const AlignOptions& options) {
  validate(o1);
  return best_unit(registration::surface_source(o1)(kUnitSamples), o2, found, options);
}

std::optional<OtherUnit> find_other_unit(std::span<const Vec3> points, std::span<const Vec3> normals,
                                         const Sites& o2, const Alignment& found,
                                         const AlignOptions& options) {
  return best_unit(registration::cloud_source(points, normals)(kUnitSamples), o2, found, options);
}

}  // namespace sdm
