// The measures of the small module: the others, with what they need, would add 48 kB to 295 as Brotli.
#include <sdm/error.h>
#include <sdm/map.h>

#include <string>

#include "module/arguments.h"
#include "module/measures.h"

namespace sdm::js {
namespace {

MapOptions map_options(const GivenOptions& given) {
  for (const GivenValue& value : values_of(given))
    if (value.name == "along" || value.name == "measure")
      throw Error(std::string(value.name) + " needs the module of start({ full: true })");
  auto options = read_options<MapOptions>(given);
  options.progress = host_progress();
  return options;
}

}  // namespace

void measure(const Surface& surface, const Sites& sites, const GivenMeasure& given, DistanceMap& map) {
  compute_map(surface, sites, map_options(given.options), map);
}

void measure_samples(const Surface& surface, const Sites& sites, const GivenMeasure& given,
                     const SampleRange& range, DistanceMap& map) {
  compute_samples(surface, sites, map_options(given.options), range, map);
}

}  // namespace sdm::js
