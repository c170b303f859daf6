#include "map_options.h"

#include "common_options.h"
#include "option_checks.h"

void add_options(CLI::App& app, MapCommand& c) {
  const auto positive = number("a positive number", [](double x) { return x > 0; });
  app.add_option("O1", c.o1, "The mesh that is measured on (OBJ, PLY, STL, OFF, glTF, 3DS)")->required();
  app.add_option("O2", c.o2, "The mesh that distances are measured to")->required();
  add_output_option(app, c.out);
  app.add_flag("--both", c.both, "Measure O2 as well: results in DIR/o1 and DIR/o2");

  add_transform_option(app, "--transform-o1", "O1", c.transform_o1);
  add_transform_option(app, "--transform-o2", "O2", c.transform_o2);

  CLI::Option* resolution = add_resolution_option(app, c.atlas);
  app.add_option(
         "--precision", c.precision,
         "Instead: as many texels as it takes for no point to be farther than EPS from a texel's sample, so "
         "that distances between samples are known to EPS (error_bound)")
      ->check(positive)
      ->type_name("EPS")
      ->excludes(resolution);
  add_layout_options(app, c.atlas, "O1");

  app.add_option("--max-distance", c.map.max_distance, "Texels farther than this hold no value")
      ->check(positive)
      ->type_name("D");
  add_choice<sdm::SignMethod>(app, "--sign", c.map.sign,
                              "How the inside of O2 (negative) is told; auto: only where O2 is closed",
                              {{"auto", sdm::SignMethod::automatic},
                               {"none", sdm::SignMethod::none},
                               {"pseudonormal", sdm::SignMethod::pseudonormal},
                               {"winding", sdm::SignMethod::winding}});
  add_choice<sdm::EngineKind>(
      app, "--engine", c.map.engine,
      "The fast engine, the plain one to compare it with, or the paper's, which draws with OpenGL",
      {{"cpu", sdm::EngineKind::cpu},
       {"reference", sdm::EngineKind::reference},
       {"gl", sdm::EngineKind::gl}});
  app.add_option("--gl-device", c.map.raster.device,
                 "gl: the device, by its number in `sdm devices` or a part of its name")
      ->type_name("NAME");
  add_choice<sdm::GlClip>(
      app, "--clip", c.map.raster.clip,
      "gl: what keeps polygons within faces of O1, planes or, as in the paper, a cache of stencil values",
      {{"planes", sdm::GlClip::planes}, {"stencil", sdm::GlClip::stencil}});
  app.add_option("--stencil-values", c.map.raster.stencil_values,
                 "gl, --clip stencil: how many values the faces share")
      ->check(whole_number(1, 255))
      ->type_name("K")
      ->capture_default_str();
  app.add_flag_callback(
      "--no-bound-culling", [&c] { c.map.raster.bound_culling = false; },
      "gl: keep sites that upper bounds on the distance rule out; the map is the same");
  app.add_option("--tolerance", c.picture.tolerance,
                 "Colour bands and exit code 3 where a distance is above D, inside or outside")
      ->check(number("a number, 0 or more", [](double x) { return x >= 0; }))
      ->type_name("D");

  add_picture_options(app, c.picture, c.range);
  add_run_options(app, c.threads, c.json, c.quiet, "the report (report.json) instead of a summary");
}

void check_combination(const CLI::App& app, const MapCommand& c) {
  check_range(c.range);
  if (c.picture.tolerance && *c.picture.tolerance > c.map.max_distance)
    throw CLI::ValidationError("--tolerance",
                               "must not be above --max-distance, which hides what exceeds it");
  for (const char* option : {"--gl-device", "--clip", "--stencil-values", "--no-bound-culling"})
    if (app.count(option) > 0 && c.map.engine != sdm::EngineKind::gl)
      throw CLI::ValidationError(option, "needs --engine gl");
  if (app.count("--stencil-values") > 0 && c.map.raster.clip != sdm::GlClip::stencil)
    throw CLI::ValidationError("--stencil-values", "needs --clip stencil");
}
