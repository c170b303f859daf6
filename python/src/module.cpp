#include <sdm/version.h>

#include "objects.h"
#include "options.h"

NB_MODULE(_core, module) {
  using namespace sdm::python;
  module.doc() = "The compiled part of the package sdm, which exports its names.";
  module.attr("version") = sdm::kVersion;
  // Python does not free what modules refer to when it exits, which is no leak. The tests switch the warnings
  // on.
  nb::set_leak_warnings(false);
  module.def("set_leak_warnings", &nb::set_leak_warnings, nb::arg("on"));
  bind_errors(module);
  bind_options(module);
  bind_meshes(module);
  bind_sites(module);
  bind_batches(module);
  bind_surface(module);
  bind_groups(module);
  bind_map(module);
  bind_matches(module);
  bind_parts(module);
  bind_proximity(module);
  bind_bodies(module);
  bind_alignments(module);
  bind_poses(module);
  bind_surfaces(module);
  bind_simplify(module);
  bind_metrics(module);
  bind_time_of_contact(module);
  bind_volume(module);
  bind_baking(module);
  bind_points(module);
  bind_scenes(module);
  bind_result_tables(module);
  bind_pickle();
}
