#include "pair_options.h"

#include "option_checks.h"

void add_options(CLI::App& app, PairCommand& c, const std::array<std::string, 2>& bodies) {
  app.add_option("O1", c.o1, bodies[0])->required();
  app.add_option("O2", c.o2, bodies[1])->required();
  const std::string steps = ", placed by steps such as fit,rotate:0:90:0,scale:2,translate:0.8:0:0";
  app.add_option("--transform-o1", c.transform_o1, "O1" + steps)->check(check_transform)->type_name("STEPS");
  app.add_option("--transform-o2", c.transform_o2, "O2" + steps)->check(check_transform)->type_name("STEPS");
  app.add_flag("--exact", c.options.exact,
               "Separation and collision from the triangles themselves, not from samples with bounds");
  app.add_option("--margin", c.options.contact_margin,
                 "Contacts of all that is as near as D, not only inside")
      ->check(number("a number, 0 or more", [](double x) { return x >= 0; }))
      ->type_name("D");
  app.add_option("--resolution", c.options.atlas.resolution, "Texels along each side of both bodies' maps")
      ->check(whole_number(16, 32768))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--units", c.units, "Of the meshes, for what is printed and drawn")->type_name("NAME");
  app.add_option("--threads", c.threads, "Threads to use, 0 for all cores")
      ->check(whole_number(0, 1024))
      ->type_name("N")
      ->capture_default_str();
  app.add_flag("--json", c.json, "Print JSON instead of a summary");
  app.add_flag("--quiet", c.quiet, "Print nothing but errors, and what --json asks for");
}
