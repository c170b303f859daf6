#include "pair_options.h"

#include "common_options.h"
#include "option_checks.h"

void add_options(CLI::App& app, PairCommand& c, const std::array<std::string, 2>& bodies) {
  app.add_option("O1", c.o1, bodies[0])->required();
  app.add_option("O2", c.o2, bodies[1])->required();
  add_transform_option(app, "--transform-o1", "O1", c.transform_o1);
  add_transform_option(app, "--transform-o2", "O2", c.transform_o2);
  add_proximity_options(app, c.units, c.options.contact_margin, c.options.depth_precision);
  add_run_options(app, c.threads, c.json, c.quiet, "JSON instead of a summary");
}
