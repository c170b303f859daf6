// The numbers of a map: statistics, bounds, and whether it is within a tolerance.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <sdm/hausdorff.h>
#include <sdm/sampling_bound.h>
#include <sdm/summary.h>
#include <sdm/verdict.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include "fields.h"
#include "map.h"
#include "options.h"

namespace sdm::python {
namespace {

// Whether distances change by no more than the point moves also where they change their sign.
bool sign_is_continuous(const PyMap& self) {
  return self.map.sign.method == SignMethod::none || (self.to->sites.closed() && self.to->sites.orientable());
}

// No texel beyond the maximum distance has a smaller distance than this. A ball inside O2 is inside its box,
// so that no point is deeper than half of the box's shortest side.
double least_beyond(const PyMap& self) {
  const double max_distance = self.options.max_distance;
  if (self.map.sign.method == SignMethod::none) return max_distance;
  const Box box = sdm::bounds(self.to->sites.mesh());
  double deepest = kInfinity;
  for (int k = 0; k < 3; ++k) deepest = std::min(deepest, (box.upper[k] - box.lower[k]) / 2);
  return deepest < max_distance ? max_distance : -deepest;
}

// (lower, upper, covering radius, accuracy): lower ≤ d(p) ≤ upper for all points p of the surface.
nb::object bounds(const PyMap& self) {
  self.require_bounds();
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  double lower = kInfinity, upper = -lower, radius = 0;
  const double accuracy = self.accuracy();
  run_sized(self.texels(), [&] {
    const SamplingBound bound(self.on->surface);
    const auto texels = self.on->surface.sample_texels();
    const auto radii = bound.sample_radii();
    radius = bound.value();
    const bool keep_sign = sign_is_continuous(self);
    for (std::size_t i = 0; i < texels.size(); ++i) {
      const double d = self.map.distance[texels[i]];
      if (!std::isfinite(d)) continue;
      const double reach = double{radii[i]} + accuracy;
      lower = std::min(lower, d - reach);
      upper = std::max(upper, (keep_sign ? d : std::abs(d)) + reach);
    }
    if (self.map.beyond_max_distance > 0) {
      upper = kInfinity;
      lower = std::min(lower, least_beyond(self) - radius - accuracy);
    }
    if (self.map.sign.method == SignMethod::none) lower = std::max(lower, 0.0);
    if (!keep_sign) lower = -upper;
  });
  return nb::make_tuple(lower, upper, radius, accuracy);
}

// Bounds on the largest |d(p)| of all points p of the surface, from the texels.
BoundedLength largest_distance(const PyMap& self) {
  const double accuracy = self.accuracy();
  if (self.map.beyond_max_distance > 0) {  // somewhere, and not known by how much
    const double least = std::max(0.0, self.options.max_distance - accuracy);
    return {{.value = least, .lower = least, .upper = kInfinity}};
  }
  const Surface& surface = self.on->surface;
  const SamplingBound bound(surface);
  const auto texels = surface.sample_texels();
  const auto radii = bound.sample_radii();
  BoundedLength result;
  std::uint32_t farthest = kNone;
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const double d = std::abs(self.map.distance[texels[i]]);
    result.upper = std::max(result.upper, d + double{radii[i]} + accuracy);
    if (farthest != kNone && d <= result.value) continue;
    farthest = texels[i];
    result.value = d;
  }
  result.lower = std::max(0.0, result.value - accuracy);
  if (farthest != kNone) {
    const Vec3 from = surface.texel_point(farthest);
    const Vec3f& v = self.map.vector[farthest];
    result.witness = {from, Vec3{from[0] + v[0], from[1] + v[1], from[2] + v[2]}};
  }
  return result;
}

BoundedLength hausdorff(const PyMap& self, std::optional<double> precision, nb::handle progress) {
  self.require_bounds();
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  BoundedLength result;
  run(progress, [&](const Progress& report) {
    result = precision ? one_sided_hausdorff(self.on->surface.mesh(), self.to->sites,
                                             {.precision = *precision, .progress = report})
                             .distance
                       : largest_distance(self);
  });
  return result;
}

CertifiedVerdict check_tolerance(const PyMap& self, nb::handle tolerance, double uncertainty,
                                 nb::handle fail_area, nb::handle fail_share, nb::handle progress) {
  require_uncertainty(uncertainty);
  SummaryOptions asked;
  if (!fail_area.is_none()) set_option(option_of(&SummaryOptions::fail_area), fail_area, asked);
  if (!fail_share.is_none()) set_option(option_of(&SummaryOptions::fail_share), fail_share, asked);
  if (!self.thickness && !self.along) self.require_other_mesh();
  const Tolerance accepted = tolerance_of(tolerance, self.map.sign.method);
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  CertifiedVerdict result;
  run(progress, [&](const Progress& report) {
    const Surface& surface = self.on->surface;
    if (self.thickness) {
      result = *summarize_thickness(surface, self.map,
                                    {.accuracy = self.accuracy(),
                                     .guard = self.guard(),
                                     .uncertainty = uncertainty,
                                     .fail_area = asked.fail_area,
                                     .fail_share = asked.fail_share,
                                     .tolerance = accepted})
                    .tolerance;
      return;
    }
    result = certify_tolerance(surface, self.to->sites, self.map, self.vertex_distances(report), accepted,
                               {.error_bound = covering_radius(surface),
                                .accuracy = self.accuracy(),
                                .guard = self.guard(),
                                .uncertainty = uncertainty,
                                .fail_area = asked.fail_area,
                                .fail_share = asked.fail_share,
                                .progress = report});
  });
  return result;
}

void bind_statistics(nb::module_& module) {
  using S = DistanceStatistics;
  nb::class_<S> statistics(
      module, "DistanceStatistics", nb::is_weak_referenceable(),
      "Statistics of the texels of a map that have a value, each weighted by its area on the surface. "
      "Distances are NaN if there are none. Estimates for the surface: DistanceMap.bounds holds everywhere.");
  bind_fields(statistics).def("__repr__", [](const S& s) {
    return nb::str("sdm.DistanceStatistics(min={:.6g}, max={:.6g}, mean={:.6g}, rms={:.6g}, texels={})")
        .format(s.min, s.max, s.mean, s.rms, s.texels);
  });
}

// (distance, point), or None.
nb::object witness_of(const CertifiedVerdict& verdict) {
  if (!verdict.proof || !verdict.proof->witness) return nb::none();
  const ToleranceWitness& witness = *verdict.proof->witness;
  return nb::make_tuple(witness.distance,
                        nb::make_tuple(witness.point[0], witness.point[1], witness.point[2]));
}

void bind_verdict(nb::module_& module) {
  using V = CertifiedVerdict;
  nb::class_<V> verdict(module, "ToleranceVerdict", nb::is_weak_referenceable(),
                        "Whether the distances of all points of a surface are within a tolerance.");
  bind_fields(verdict)
      .def_prop_ro(
          "above_area_fraction", [](const V& self) { return self.shares.above; },
          text_of_field<ToleranceShares>("above").c_str())
      .def_prop_ro(
          "below_area_fraction", [](const V& self) { return self.shares.below; },
          text_of_field<ToleranceShares>("below").c_str())
      .def_prop_ro("witness", &witness_of,
                   nb::sig("def witness(self) -> tuple[float, tuple[float, float, float]] | None"),
                   (text_of_field<ToleranceProof>("witness") + " Its distance, and where it is.").c_str())
      .def_prop_ro(
          "undecided_by", [](const V& self) { return self.proof ? self.proof->undecided_by : std::nullopt; },
          text_of_field<ToleranceProof>("undecided_by").c_str())
      .def_prop_ro(
          "by_places",
          [](const V& self) -> nb::object {
            if (!self.by_places) return nb::none();
            return nb::make_tuple(self.by_places->least, self.by_places->certain, self.by_places->possible);
          },
          nb::sig("def by_places(self) -> tuple[float, float, float] | None"),
          "Where the size of connected places decides: the area that makes a 'fail', that of the largest "
          "place that is "
          "out of the tolerance for certain, and of the largest one that may be; estimates, in squared "
          "units.")
      .def("__repr__", [](const V& self) {
        if (!self.largest) return nb::str("sdm.ToleranceVerdict({!r})").format(word_of(self.verdict));
        return nb::str("sdm.ToleranceVerdict({!r}, largest={:.6g})")
            .format(word_of(self.verdict), *self.largest);
      });
}

}  // namespace

std::string word_of(Verdict verdict) {
  std::string word = sdm::name_of(verdict);
  for (char& c : word) c = static_cast<char>(std::tolower(c));
  return word;
}

Tolerance tolerance_of(nb::handle value, SignMethod sign) {
  ColorChoice choice;
  set_option(option_of(&ColorChoice::tolerance), value, choice);
  require_sign(*choice.tolerance, sign);
  return *choice.tolerance;
}

void require_sign(const Tolerance& tolerance, SignMethod sign) {
  if (tolerance.needs_sign() && sign == SignMethod::none)
    throw Error("a tolerance that differs by the sign needs signed distances, but these are unsigned");
}

void require_uncertainty(double uncertainty) {
  if (!(uncertainty >= 0 && std::isfinite(uncertainty)))
    throw Error("the uncertainty must be a number of at least 0");
}

void bind_map_numbers(nb::module_& module, nb::class_<PyMap>& map) {
  bind_statistics(module);
  bind_verdict(module);
  map.def("statistics",
          [](const PyMap& self) {
            const auto lock = self.use_surface();
            return run_short([&] { return statistics(self.on->surface, self.map); });
          })
      .def("bounds", &bounds, nb::sig("def bounds(self) -> tuple[float, float, float, float]"))
      .def("hausdorff", &hausdorff, nb::arg("precision").none(), nb::arg("progress").none())
      .def("check", &check_tolerance, nb::arg("tolerance").none(), nb::arg("uncertainty"),
           nb::arg("fail_area").none(), nb::arg("fail_share").none(), nb::arg("progress").none());
}

}  // namespace sdm::python
