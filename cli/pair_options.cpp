#include "pair_options.h"

void add_options(CLI::App& app, PairCommand& c, const std::array<std::string, 2>& bodies) {
  add_pair_arguments(app, c, bodies);
  add_pair_transforms(app, c);
  add_proximity_options(app, c.units, c.options.contact_margin, c.options.depth_precision);
  add_run_options(app, c, "JSON instead of a summary");
}
