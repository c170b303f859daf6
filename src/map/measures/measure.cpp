#include <sdm/measure.h>

#include <new>
#include <type_traits>

#include "core/memory.h"
#include "map/along_measure.h"
#include "map/measure.h"
#include "map/measures/self_measure.h"
#include "map/measures/thickness_measure.h"

namespace sdm {
namespace {

map::AlongMeasure face_measure(const Mesh& mesh, const Sites& sites, const AlongOptions& options) {
  return {mesh, sites, options};
}

self::SelfMeasure face_measure(const Mesh& mesh, const Sites& sites, const SelfOptions& options) {
  return {mesh, sites, options};
}

thickness::ThicknessMeasure face_measure(const Mesh& mesh, const Sites& sites,
                                         const ThicknessOptions& options) {
  return {mesh, sites, options};
}

template <class Options>
constexpr bool kByEngine = std::is_same_v<Options, MapOptions>;

}  // namespace

DistanceMap compute_map(const Surface& surface, const Sites& sites, const Measure& measure) try {
  return std::visit(
      [&]<class Options>(const Options& options) {
        if constexpr (kByEngine<Options>) {
          return compute_map(surface, sites, options);
        } else {
          DistanceMap map;
          map::measure_texels(surface, face_measure(surface.mesh(), sites, options), map);
          return map;
        }
      },
      measure);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a map");
}

void compute_samples_of_measure(const Surface& surface, const Sites& sites, const Measure& measure,
                                const SampleRange& range, DistanceMap& map) try {
  std::visit(
      [&]<class Options>(const Options& options) {
        if constexpr (kByEngine<Options>) {
          compute_samples(surface, sites, options, range, map);
        } else {
          map::check_part(surface, range, map);
          map::measure_texels(surface, face_measure(surface.mesh(), sites, options), range, map);
        }
      },
      measure);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a map");
}

std::vector<float> distances_at_vertices(const Mesh& mesh, const Sites& sites, const Measure& measure) try {
  return std::visit(
      [&]<class Options>(const Options& options) {
        if constexpr (kByEngine<Options>)
          return distances_at_vertices(mesh, sites, options);
        else
          return map::measure_vertices(mesh, face_measure(mesh, sites, options));
      },
      measure);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the distances of vertices");
}

}  // namespace sdm
