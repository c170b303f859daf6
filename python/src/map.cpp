// Maps: what python/sdm/_distance_map.py presents.
#include "map.h"

#include <nanobind/stl/optional.h>

#include <array>
#include <chrono>
#include <string>
#include <utility>

#include "arrays.h"
#include "groups.h"
#include "options.h"
#include "rays.h"
#include "signatures.h"

namespace sdm::python {
namespace {

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

std::unique_ptr<PyMap> map_between(nb::handle surface, nb::handle sites) {
  auto result = std::make_unique<PyMap>();
  result->surface_object = nb::borrow(surface);
  result->sites_object = nb::borrow(sites);
  result->on = &nb::cast<const PySurface&>(surface);
  result->to = &nb::cast<const PySites&>(sites);
  result->surface_shape = result->on->shape;
  result->surface_edits = result->on->edits;
  result->sites_shape = result->to->shape;
  return result;
}

/// Computes the map of what `prepare` sets in it.
template <class Prepare>
std::unique_ptr<PyMap> compute(nb::handle surface, nb::handle sites, const char* engine, nb::handle progress,
                               const Prepare& prepare) {
  const auto lock = nb::cast<const PySurface&>(surface).access.use();
  const auto sites_lock = nb::cast<const PySites&>(sites).access.use();
  auto result = map_between(surface, sites);
  result->engine = engine;
  run(progress, [&](const Progress& report) {
    const auto begin = std::chrono::steady_clock::now();
    prepare(*result, report);
    result->map = compute_map(result->on->surface, result->to->sites, result->measure(report));
    result->ms = milliseconds_since(begin);
  });
  return result;
}

std::unique_ptr<PyMap> compute_pair(nb::handle surface, nb::handle sites, const nb::dict& given,
                                    const char* engine, nb::handle progress) {
  if (given.contains("along") && !given["along"].is_none()) {
    AlongOptions options;
    set_options(given, options);
    return compute(surface, sites, "along", progress, [&](PyMap& map, const Progress&) {
      map.options = {.max_distance = options.max_distance};
      map.along = options;
    });
  }
  MapOptions options{.engine = engine_of(engine)};
  set_options(given, options);
  return compute(surface, sites, engine, progress,
                 [&](PyMap& map, const Progress&) { map.options = options; });
}

std::unique_ptr<PyMap> compute_self(nb::handle surface, nb::handle sites, nb::handle rest,
                                    const nb::dict& given, nb::handle progress) {
  SelfProximityOptions options;
  set_options(given, options);
  set_options(given, options.exclusion);
  const Mesh at_rest = mesh_of(rest, nb::none());
  return compute(surface, sites, "self", progress, [&](PyMap& map, const Progress& report) {
    map.options = {.sign = SignMethod::none, .max_distance = options.max_distance};
    map.exclusion =
        std::make_shared<Exclusion>(at_rest, ExclusionOptions{.rule = options.exclusion, .progress = report});
  });
}

std::unique_ptr<PyMap> compute_thickness(nb::handle surface, nb::handle sites, const nb::dict& given,
                                         nb::handle progress) {
  ThicknessOptions options;
  set_options(given, options);
  return compute(surface, sites, "thickness", progress, [&](PyMap& map, const Progress&) {
    map.options = {.sign = SignMethod::none};
    map.thickness = {options.method, options.angle};
  });
}

}  // namespace

Measure PyMap::measure(const Progress& progress) const {
  const auto with_progress = [&](auto chosen) {
    chosen.progress = progress;
    return chosen;
  };
  if (along) return with_progress(*along);
  if (thickness)
    return ThicknessOptions{.method = thickness->first, .angle = thickness->second, .progress = progress};
  if (exclusion)
    return SelfOptions{.exclusion = *exclusion, .max_distance = options.max_distance, .progress = progress};
  return with_progress(options);
}

std::vector<float> PyMap::vertex_distances(const Progress& progress) const {
  return distances_at_vertices(on->surface.mesh(), to->sites, measure(progress));
}

void bind_map(nb::module_& module) {
  nb::class_<PyMap> map_class(module, "Map", "The compiled part of DistanceMap.");
  map_class
      .def_prop_ro(
          "surface", [](const PyMap& self) { return self.surface_object; },
          nb::sig("def surface(self) -> Surface"))
      .def_prop_ro(
          "sites", [](const PyMap& self) { return self.sites_object; }, nb::sig("def sites(self) -> Sites"))
      .def_prop_ro("beyond_max_distance", [](const PyMap& self) { return self.map.beyond_max_distance; })
      .def_prop_ro("without_match", [](const PyMap& self) { return self.map.without_match; })
      .def_prop_ro("measured", [](const PyMap& self) { return self.map.measured.text; })
      .def_prop_ro("sign", [](const PyMap& self) { return name_of(self.map.sign.method); })
      .def_prop_ro("sign_reason", [](const PyMap& self) { return self.map.sign.reason; })
      .def(
          "at_vertices",
          [](const PyMap& self, nb::handle progress) {
            const auto lock = self.use_surface();
            const auto sites_lock = self.use_sites();
            std::vector<float> distances;
            run(progress, [&](const Progress& report) { distances = self.vertex_distances(report); });
            const std::size_t count = distances.size();
            return array_of<float>(std::move(distances), {count});
          },
          nb::arg("progress") = nb::none(),
          nb::sig("def at_vertices(self, progress: object = None) -> numpy.typing.NDArray[numpy.float32]"));
  bind_map_numbers(module, map_class);
  bind_map_groups(map_class);
  bind_map_files(module, map_class);
  bind_map_rays(map_class);
  bind_map_transfer(map_class);
  bind_channels(module);
  bind_computation(module);
}

void bind_computation(nb::module_& module) {
  static const std::string ends = std::string("options: dict[str, object], *, ") + kProgress + "Map";
  static const std::array signatures{
      "def compute_map(surface: Surface, sites: Sites, options: dict[str, object], *, engine: str = 'cpu', " +
          std::string(kProgress) + "Map",
      "def compute_self_map(surface: Surface, sites: Sites, rest: object, " + ends,
      "def compute_thickness(surface: Surface, sites: Sites, " + ends};
  module.def(
      "compute_map",
      [](nb::handle surface, nb::handle sites, const nb::dict& options, const char* engine,
         nb::handle progress) { return compute_pair(surface, sites, options, engine, progress).release(); },
      nb::rv_policy::take_ownership, nb::arg("surface"), nb::arg("sites"), nb::arg("options"), nb::kw_only(),
      nb::arg("engine") = "cpu", nb::arg("progress") = nb::none(), nb::sig(signatures[0].c_str()));
  module.def(
      "compute_self_map",
      [](nb::handle surface, nb::handle sites, nb::handle rest, const nb::dict& options,
         nb::handle progress) { return compute_self(surface, sites, rest, options, progress).release(); },
      nb::rv_policy::take_ownership, nb::arg("surface"), nb::arg("sites"), nb::arg("rest").none(),
      nb::arg("options"), nb::kw_only(), nb::arg("progress") = nb::none(), nb::sig(signatures[1].c_str()));
  module.def(
      "compute_thickness",
      [](nb::handle surface, nb::handle sites, const nb::dict& options, nb::handle progress) {
        return compute_thickness(surface, sites, options, progress).release();
      },
      nb::rv_policy::take_ownership, nb::arg("surface"), nb::arg("sites"), nb::arg("options"), nb::kw_only(),
      nb::arg("progress") = nb::none(), nb::sig(signatures[2].c_str()));
}

}  // namespace sdm::python
