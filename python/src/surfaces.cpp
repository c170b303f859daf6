// The Hausdorff distance of two surfaces, and how much of one has a point of the other near it.
#include <nanobind/stl/optional.h>
#include <sdm/doubts.h>

#include <string>
#include <utility>

#include "fields.h"
#include "options.h"
#include "signatures.h"
#include "sites_in_use.h"

namespace sdm::python {
namespace {

/// Warns of faces that a distance leaves out, as it is no statement about them.
void warn_of_unmatched(const HausdorffDistance& distance, const char* from, const char* to) {
  if (distance.faces_without_match == 0) return;
  const std::string text = std::to_string(distance.faces_without_match) + " faces of " + from +
                           " are left out: no face of " + to + " faces as they do";
  if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 1) < 0) throw nb::python_error();
}

BoundedLength hausdorff_of(nb::handle a, nb::handle b, bool one_sided, nb::handle progress,
                           const nb::kwargs& given) {
  check_keywords("hausdorff", given);
  HausdorffOptions options;
  set_options(given, options);
  SitesInUse on(a), to(b);
  BoundedLength result;
  SymmetricHausdorff both;
  run(progress, [&](const Progress& report) {
    options.progress = report;
    if (one_sided) {
      both.from[0] = one_sided_hausdorff(on.get().mesh(), to.get(), options);
      result = both.from[0].distance;
    } else {
      both = symmetric_hausdorff(on.get(), to.get(), options);
      result = both.larger.distance;
      if (both.larger_from == 1 && result.witness) std::swap((*result.witness)[0], (*result.witness)[1]);
    }
  });
  warn_of_unmatched(both.from[0], "a", "b");
  warn_of_unmatched(both.from[1], "b", "a");
  return result;
}

void bind_hausdorff(nb::module_& module) {
  static const std::string signature = "def hausdorff(a: object, b: object, *, one_sided: bool = False, " +
                                       option_signature("hausdorff") + kProgress + "BoundedLength";
  static const std::string documentation =
      R"(Returns the Hausdorff distance of two surfaces, with certified bounds.

a, b: any form of a mesh (see Mesh), or Sites. Any triangle soups.
one_sided: only the largest distance from a point of a to the closest point of b, which is 0 where a is a part
of b, as ``sdm hausdorff`` measures by default; otherwise the larger one of both directions, as with its --both.
)" + option_documentation("hausdorff") +
      R"( Faces without such a face are left out, with a RuntimeWarning.
progress: called as progress(step, fraction), on this thread; False cancels.

The witness is a point of a and a point of b that are ``value`` apart. Nothing is sampled: lower ≤ truth ≤
upper, rounding included. Raises Error for an unusable mesh, or a precision that is not positive.

>>> distance = sdm.hausdorff(box, sphere)
>>> distance.lower <= distance.value <= distance.upper
True
>>> sdm.hausdorff(box, box).value
0.0)";
  module.def("hausdorff", &hausdorff_of, nb::arg("a").none(), nb::arg("b").none(), nb::kw_only(),
             nb::arg("one_sided") = false, nb::arg("progress") = nb::none(), nb::arg("options"),
             nb::sig(signature.c_str()), documentation.c_str());
}

void bind_coverage(nb::module_& module) {
  using C = CoverageMap;
  nb::class_<C> coverage_class(module, "Coverage", nb::is_weak_referenceable(),
                               "The share of the area of O2 that has a measured point near it.");
  bind_fields(coverage_class).def("__repr__", [](const C& self) {
    return nb::str("sdm.Coverage({:.4g}, from {:.4g} to {:.4g})").format(self.value, self.lower, self.upper);
  });
  static const std::string coverage_signature =
      std::string("def coverage(o2: object, measured: object, reach: float, *, ") + kProgress + "Coverage";
  module.def(
      "coverage",
      [](nb::handle o2, nb::handle measured, double reach, nb::handle progress) {
        const Mesh mesh = mesh_of(o2, nb::none());
        SitesInUse on(measured);
        CoverageMap result;
        run(progress, [&](const Progress& report) {
          result = coverage_map(mesh, on.get(), reach, {.progress = report});
        });
        return result;
      },
      nb::arg("o2").none(), nb::arg("measured").none(), nb::arg("reach"), nb::kw_only(),
      nb::arg("progress") = nb::none(), nb::sig(coverage_signature.c_str()),
      R"(Returns how much of the area of O2 has a point of the measured surface within a reach.

o2: any form of a mesh (see Mesh). measured: the same, or Sites.
reach: a length, greater than 0.
progress: called as progress(step, fraction), on this thread; False cancels.

Raises Error for an unusable mesh or reach. Cost: a closest point for each face of O2 and each piece of those
that are not decided as a whole.

>>> sdm.coverage(box, box, 0.1).value
1.0)");
}

}  // namespace

void bind_surfaces(nb::module_& module) {
  bind_hausdorff(module);
  bind_coverage(module);
}

}  // namespace sdm::python
