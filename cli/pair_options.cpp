#include "pair_options.h"

#include "declared_options.h"

void add_options(CLI::App& app, PairCommand& c, const std::array<std::string, 2>& bodies) {
  add_pair_arguments(app, c, bodies);
  add_pair_transforms(app, c);
  add_declared_options(app, c.options);
  add_units_option(app, c.units);
  add_run_options(app, c, "JSON instead of a summary");
}
