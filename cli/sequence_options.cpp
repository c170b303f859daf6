#include "sequence_options.h"

#include "cad_options.h"
#include "common_options.h"
#include "declared_options.h"
#include "doubts.h"
#include "option_checks.h"

using Json = nlohmann::ordered_json;

namespace {

void add_output_options(CLI::App& app, SequenceCommand& c) {
  add_output_option(app, c.out);
  add_engine_option(app, c.engine);
  if (sdm::can_write_html())
    app.add_flag("--player", c.outputs.player,
                 "Write player.html, a page that plays the frames, with their distances at vertices");
  app.add_flag("--animation", c.outputs.animation,
               "Write animation.glb, a model that any viewer of glTF plays, coloured by distance");
  app.add_flag("--both", c.both,
               "Also measure O2: its distances to O1, maps NNNN_o2 with --maps, colours in the player");
  add_tolerance_option(app, c.picture.tolerance);
  add_uncertainty_option(app, c.uncertainty);
  add_accept_doubts(app, c.accept_doubts,
                    "PASS stays PASS where the unit of O1 or thin walls leave a doubt, instead of DOUBTFUL.");
  add_color_options(app, c.picture);
  add_up_option(app, c.picture.up,
                "The axis of the meshes that points up, in player.html and animation.glb.");
  app.add_option("--maps", c.outputs.maps_every, "Write the map of O1 of every K-th frame, as EXR and PNG")
      ->transform(whole_number(1, 1000000))
      ->type_name("K");
}

void add_reading_options(CLI::App& app, SequenceCommand& c) {
  add_deflection_option(app, c.reading.tessellation);
  add_declared_options(
      app, c.reading, {},
      {{"allow_topology",
        "Numbered files may add and remove vertices and faces between frames; what stays keeps its texels, "
        "and maps over time are of what stays."}});
  app.add_flag("--resume", c.resume,
               "Continue an interrupted run in the same folder, with the same inputs and options; "
               "without one, start from the first frame");
  app.add_flag("--keep-going", c.keep_going, "Skip frames that cannot be read");
  app.add_flag_callback(
      "--no-temporal", [&c] { c.outputs.temporal = false; },
      "Do not compute maps over time; faster, because frames then need no complete map");
}

}  // namespace

void add_options(CLI::App& app, SequenceCommand& c) {
  add_options(app, c.pair, {"A sequence, or a mesh at rest", "The other sequence or mesh"});
  add_resolution_option(app, c.atlas, "both bodies' maps");
  app.add_option("--map-precision", c.map_precision,
                 "A resolution of O1's map for which its error bound is at most EPS in every frame, instead "
                 "of --resolution; reads all frames beforehand")
      ->check(positive_number())
      ->type_name("EPS");
  add_layout_options(app, c.atlas);
  add_output_options(app, c);
  add_reading_options(app, c);
}

void check_combination(const SequenceCommand& c) {
  if (c.outputs.collect() && c.reading.allow_topology)
    throw CLI::ValidationError(c.outputs.player ? "--player" : "--animation",
                               "needs bodies that keep their faces: omit --allow-topology");
  check_layout(c.atlas);
  // The gl engine would lay out its tiles anew after each edit.
  if (c.reading.allow_topology && c.engine.name == "gl")
    throw CLI::ValidationError("--allow-topology", "cannot be used with --engine gl");
}

Json optional(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

Json options_json(const SequenceCommand& c) {
  const auto& range = c.picture.range;
  const auto& tolerance = c.picture.tolerance;
  return {{"version", sdm::kVersion},
          {"--transform-o1", c.pair.transform_o1},
          {"--transform-o2", c.pair.transform_o2},
          {"--units", c.pair.units},
          {"--contact-margin", c.pair.options.contact_margin},
          {"--depth-precision", optional(c.pair.options.depth_precision)},
          {"--resolution", {c.atlas.resolution, c.atlas.rows.value_or(0)}},
          {"--map-precision", c.map_precision},
          {"--maps", c.outputs.maps_every},
          {"--rate", optional(c.reading.rate)},
          {"--deflection", optional(c.reading.tessellation.deflection)},
          {"--allow-topology", c.reading.allow_topology},
          {"--engine", c.engine.name},
          {"--no-temporal", !c.outputs.temporal},
          {"--atlas", c.atlas.kind},
          {"--gutter", c.atlas.gutter},
          {"--max-stretch", c.atlas.max_stretch},
          {"--strict-uv", c.atlas.strict_uv},
          {"--both", c.both},
          {"--player", c.outputs.player},
          {"--animation", c.outputs.animation},
          {"--up", c.picture.up},
          {"--colormap", c.picture.colormap},
          {"--range", range ? Json(*range) : Json::array()},
          {"--tolerance", tolerance ? Json{tolerance->lower, tolerance->upper} : Json(nullptr)},
          {"--uncertainty", c.uncertainty},
          {"--accept-doubts", c.accept_doubts}};
}
