#include "module/all_measures.h"

#include <sdm/error.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "module/arguments.h"

namespace sdm::js {
namespace {

bool has(const GivenOptions& given, std::string_view name) {
  return std::ranges::count(values_of(given), name, &GivenValue::name) > 0;
}

/// Which options are read depends on it.
MapMeasure measure_of(const GivenOptions& given) {
  constexpr auto& kMeasure = std::get<0>(kOptions<MeasureChoice>);
  MeasureChoice choice;
  for (const GivenValue& value : values_of(given))
    if (value.name == kMeasure.name && !set(kMeasure, value, choice)) refuse(info_of(kMeasure), value);
  return choice.measure;
}

Mesh mesh_at_rest(Mesh mesh, std::span<const Vec3> rest) {
  if (rest.empty()) return mesh;
  if (rest.size() != mesh.positions.size())
    throw Error("rest has " + std::to_string(rest.size()) + " vertices, but the mesh has " +
                std::to_string(mesh.positions.size()));
  std::ranges::copy(rest, mesh.positions.begin());
  return mesh;
}

}  // namespace

void with_measure(const Mesh& mesh, const GivenMeasure& given,
                  const std::function<void(const Measure&)>& use) {
  const GivenOptions& options = given.options;
  const Progress progress = host_progress();
  switch (measure_of(options)) {
    case MapMeasure::sites: {
      auto [choice, closest, along] = read_all_options<MeasureChoice, MapOptions, AlongOptions>(options);
      closest.progress = along.progress = progress;
      use(has(options, "along") ? Measure(along) : Measure(closest));
      return;
    }
    case MapMeasure::self: {
      const auto [choice, rule, self] =
          read_all_options<MeasureChoice, ExclusionRule, SelfProximityOptions>(options);
      const Exclusion exclusion(mesh_at_rest(mesh, given.rest), {.rule = rule, .progress = progress});
      use(SelfOptions{exclusion, self.max_distance, progress});
      return;
    }
    case MapMeasure::thickness: {
      auto [choice, thickness] = read_all_options<MeasureChoice, ThicknessOptions>(options);
      thickness.progress = progress;
      use(thickness);
      return;
    }
  }
}

void measure(const Surface& surface, const Sites& sites, const GivenMeasure& given, DistanceMap& map) {
  with_measure(surface.mesh(), given, [&](const Measure& measure) {
    if (const auto* closest = std::get_if<MapOptions>(&measure))
      compute_map(surface, sites, *closest, map);  // without new memory
    else
      map = compute_map(surface, sites, measure);
  });
}

void measure_samples(const Surface& surface, const Sites& sites, const GivenMeasure& given,
                     const SampleRange& range, DistanceMap& map) {
  with_measure(surface.mesh(), given, [&](const Measure& measure) {
    compute_samples_of_measure(surface, sites, measure, range, map);
  });
}

}  // namespace sdm::js
