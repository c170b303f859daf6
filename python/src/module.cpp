#include <sdm/version.h>

#include "objects.h"

NB_MODULE(_core, module) {
  using namespace sdm::python;
  module.doc() = "The compiled part of the package sdm, which exports its names.";
  module.attr("version") = sdm::kVersion;
  bind_errors(module);
  bind_meshes(module);
  bind_sites(module);
  bind_surface(module);
  bind_map(module);
  bind_proximity(module);
  bind_bodies(module);
}
