#include "map_options.h"

#include <fmt/format.h>
#include <sdm/mesh_files.h>
#include <sdm/summary.h>

#include "common_options.h"
#include "declared_options.h"
#include "islands.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace {

/// Adds the options of the layout; `both`: the option that a stored atlas excludes.
void add_map_layout(CLI::App& app, MapLayout& layout, CLI::Option* both) {
  add_resolution_option(app, layout.atlas);
  add_declared_options(app, layout.fit);
  add_layout_options(app, layout.atlas);
  app.add_option(
         "--atlas-cache", layout.cache,
         "Take the atlas of O1 from this file, or write it there if the file does not exist; it must be "
         "of the same mesh, transform and layout")
      ->type_name("FILE")
      ->excludes(app.get_option("--precision"))
      ->excludes(app.get_option("--texel-size"))
      ->excludes(both);
}

}  // namespace

void add_options(CLI::App& app, MapCommand& c) {
  add_pair_arguments(app, c,
                     {fmt::format("The mesh that distances are measured from ({})", sdm::mesh_format_names()),
                      "The mesh that distances are measured to"});
  add_output_option(app, c.output.folder);
  CLI::Option* both =
      app.add_flag("--both", c.both, "Also compute the map of O2; results in DIR/o1 and DIR/o2");

  add_pair_transforms(app, c);
  add_pair_reading(app, c);
  add_unit_options(app, c.file_units);
  add_island_option(app, c.islands);
  add_island_option_o2(app, c.islands_o2);
  add_align_options(app, c.align);
  add_map_layout(app, c.layout, both);

  add_declared_options(app, c.map);
  add_along_option(app, c.along);
  add_engine_option(app, c.engine);
  add_declared_options(
      app, c.gl, {},
      {{"device", "gl, gpu: the device, by its number in `sdm devices` or part of its name."},
       {"clip",
        "gl: how polygons are clipped to faces of O1: by planes or, as in the paper, by a stencil cache."},
       {"stencil_values", "gl, --clip stencil: the number of stencil values."},
       {"bound_culling", "gl: do not cull sites by upper bounds on the distance; the map is unchanged."}});
  add_tolerance_option(app, c.picture.tolerance);
  add_tolerance_table_option(app, c.groups);
  add_uncertainty_option(app, c.uncertainty);
  add_doubt_options(app, c.doubts);
  add_declared_option(app, sdm::option_of(&sdm::SummaryOptions::bands), c.bands);

  add_write_option(app, c.output.files, true);
  add_channels_option(app, c.output.layers);
  add_picture_options(app, c.picture);
  add_field_option(app, c.fields);
  add_run_options(app, c, "the report (report.json) instead of a summary");
}

void check_combination(const CLI::App& app, const MapCommand& c) {
  check_layout(c.layout.atlas);
  check_doubts(c.doubts, c.picture.tolerance);
  check_uncertainty(c.uncertainty, c.picture.tolerance.has_value() || !c.groups.file.empty());
  if (!std::ranges::is_sorted(c.bands, std::less_equal<>()))
    throw CLI::ValidationError("--bands", "the edges must increase");
  if (const auto& t = c.picture.tolerance;
      t && std::max(std::abs(t->lower), std::abs(t->upper)) > c.map.max_distance)
    throw CLI::ValidationError("--tolerance",
                               "must not be greater than --max-distance, beyond which texels have no value");
  if (app.count("--device") > 0 && c.engine.name != "gl" && c.engine.name != "gpu")
    throw CLI::ValidationError("--device", "needs --engine gl or gpu");
  for (const char* option : {"--clip", "--stencil-values", "--no-bound-culling"})
    if (app.count(option) > 0 && c.engine.name != "gl")
      throw CLI::ValidationError(option, "needs --engine gl");
  if (app.count("--stencil-values") > 0 && c.gl.clip != sdm::GlClip::stencil)
    throw CLI::ValidationError("--stencil-values", "needs --clip stencil");
}
