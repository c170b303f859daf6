#include "pair_options.h"

#include "common_options.h"
#include "option_checks.h"

void add_options(CLI::App& app, PairCommand& c, const std::array<std::string, 2>& bodies) {
  app.add_option("O1", c.o1, bodies[0])->required();
  app.add_option("O2", c.o2, bodies[1])->required();
  add_transform_option(app, "--transform-o1", "O1", c.transform_o1);
  add_transform_option(app, "--transform-o2", "O2", c.transform_o2);
  add_units_option(app, c.units);
  app.add_option("--margin", c.options.contact_margin,
                 "Also report contacts up to a distance of D, not only of penetrating parts")
      ->check(number("a number, 0 or more", [](double x) { return x >= 0; }))
      ->type_name("D");
  add_resolution_option(app, c.options.atlas, "both bodies' maps");
  add_run_options(app, c.threads, c.json, c.quiet, "JSON instead of a summary");
}
