#include "bake_options.h"

#include <fmt/format.h>

#include "cad_options.h"
#include "declared_options.h"

void add_options(CLI::App& app, BakeCommand& c) {
  app.add_option("HIGH", c.high,
                 fmt::format("The mesh with materials, textures or colours ({})", sdm::mesh_format_names()))
      ->required();
  app.add_option("LOW", c.low, "The mesh that gets the textures")->required();
  add_output_option(app, c.out);
  add_transform_option(app, "--transform-high", "HIGH", c.transform_high);
  add_transform_option(app, "--transform-low", "LOW", c.transform_low);
  add_deflection_option(app, c.tessellation);
  add_resolution_option(app, c.request.resolution, c.request.rows, "the textures");
  add_declared_options(
      app, c.request, {"resolution"},
      {{"channels",
        "What to bake; by default base_color, and others that HIGH has a texture for or that differ between "
        "its materials. normal: the shape of HIGH, in tangent space."},
       {"atlas",
        "How LOW is parametrised: by its own UVs, in few charts, or in pairs of triangles without "
        "distortion; "
        "auto: by its UVs if they lie in [0, 1] and faces do not overlap there, otherwise in charts."},
       {"match",
        "Which point of HIGH belongs to a texel: the closest one, the closest one that faces the same way "
        "(as "
        "--facing), or the nearest hit along the normal of LOW that does, where there is one; auto: closest, "
        "or facing if --facing is given."},
       {"facing",
        "Match the closest of the faces of HIGH that face the same way: whose normal is within this angle of "
        "that of the texel's face. For thin walls, where the closest point may be on the other skin."},
       {"cage", "How far --match ray searches along the normal, to either side."},
       {"max_distance", "Texels farther than this from HIGH have no match, and are filled from others."},
       {"occlusion_rays", "Of ambient_occlusion: rays from each point of HIGH."},
       {"thickness_method",
        "Of thickness: the diameter of the largest ball in HIGH that touches the point, or the length of the "
        "ray along the inward normal."}});
  add_declared_option(app, sdm::option_of(&sdm::PictureOptions::units), c.units,
                      {"units", "Units of the meshes; m, cm, mm, um, in, ft scale baked.glb to metres."});
  add_up_option(app, c.up, "The axis of the meshes that points up, in baked.glb.");
  app.add_flag("!--no-page", c.page, "Do not write report.html");
  add_run_options(app, c, "the report (report.json) instead of a summary");
}
