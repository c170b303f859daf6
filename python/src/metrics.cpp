// Measures that compare two surfaces.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <sdm/metrics.h>

#include <optional>
#include <string>

#include "options.h"
#include "sites_in_use.h"

namespace sdm::python {
namespace {

/// (value, lower, upper, certainty, confidence of an estimate with bounds)
nb::tuple tuple_of(const BoundedNumber& number, std::optional<double> confidence) {
  return nb::make_tuple(number.value, number.lower, number.upper, name_of(number.certainty), confidence);
}

nb::dict dict_of(const DirectedMetrics& m, const MetricsOptions& options, double confidence) {
  nb::dict result;
  const auto add = [&](const std::string& name, const BoundedNumber& number) {
    result[name.c_str()] =
        tuple_of(number, number.certainty == Certainty::estimate ? std::optional(confidence) : std::nullopt);
  };
  add("hd", m.hausdorff);
  for (std::size_t i = 0; i < m.percentiles.size(); ++i)
    add(percentile_name(options.percentiles[i]), m.percentiles[i]);
  add("mean", m.mean);
  add("rms", m.rms);
  for (std::size_t i = 0; i < m.within.size(); ++i)
    add(metric_name("within", options.tolerances[i]), m.within[i]);
  return result;
}

/// A mesh; none is one without faces.
class MeshOrNone {
 public:
  explicit MeshOrNone(nb::handle mesh) {
    if (!mesh.is_none()) in_use_.emplace(mesh);
  }
  [[nodiscard]] const Mesh& get() const { return in_use_ ? in_use_->mesh() : none_; }

 private:
  std::optional<SitesInUse> in_use_;
  Mesh none_;
};

/// Dictionaries of both together, from a to b, and from b to a, both areas, and the numbers of random points.
nb::tuple surface_metrics_of(nb::handle a, nb::handle b, const nb::dict& given, nb::handle progress) {
  MetricsOptions options;
  set_options(given, options);
  const MeshOrNone on(a), to(b);
  SurfaceMetrics metrics;
  run(progress, [&](const Progress& report) {
    options.progress = report;
    metrics = surface_metrics(on.get(), to.get(), options);
  });
  nb::dict both;
  for (const NamedMetric& m : named_metrics(metrics, options))
    both[m.name.c_str()] = tuple_of(m.number, m.confidence);
  const auto& [forth, back] = metrics.from;
  return nb::make_tuple(both, dict_of(forth, options, metrics.confidence),
                        dict_of(back, options, metrics.confidence), nb::make_tuple(forth.area, back.area),
                        nb::make_tuple(forth.points, back.points));
}

}  // namespace

void bind_metrics(nb::module_& module) {
  module.def(
      "surface_metrics", &surface_metrics_of, nb::arg("a").none(), nb::arg("b").none(), nb::arg("options"),
      nb::arg("progress").none(),
      nb::sig("def surface_metrics(a: object, b: object, options: dict[str, object], progress: object) -> "
              "tuple[typing.Any, ...]"));
}

}  // namespace sdm::python
