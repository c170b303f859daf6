#include "common_options.h"

#include <sdm/map.h>
#include <sdm/threads.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "declared_options.h"
#include "option_checks.h"

CLI::Option* add_output_option(CLI::App& app, std::filesystem::path& folder) {
  return app.add_option("-o,--output", folder, "Output folder, created if missing")
      ->required()
      ->check(CLI::Validator(
          [](const std::string& text) { return text.empty() ? "the name of the folder is empty" : ""; }, ""))
      ->type_name("DIR");
}

void add_transform_option(CLI::App& app, const std::string& name, const std::string& mesh,
                          std::string& steps) {
  app.add_option(
         name, steps,
         mesh +
             ": transform steps, such as fit,rotate:0:90:0,scale:2,translate:0.8:0:0, or matrix:FILE, "
             "4x4 row by row as text, NPY or alignment.json")
      ->check(check_transform)
      ->type_name("STEPS");
}

namespace {

const auto& kResolution = std::get<0>(sdm::kOptions<sdm::AtlasOptions>);

sdm::OptionInfo resolution_of(const sdm::AtlasOptions& atlas, const std::string& maps) {
  sdm::OptionInfo info = info_of(kResolution, atlas);
  info.text = "Texels along each side of " + maps;
  return info;
}

}  // namespace

CLI::Option* add_side_option(CLI::App& app, sdm::AtlasOptions& atlas, const std::string& maps) {
  return add_declared_option(app, resolution_of(atlas, maps), [&atlas](const std::string& text) {
    return sdm::read_value(kResolution, text, atlas);
  });
}

CLI::Option* add_resolution_option(CLI::App& app, sdm::AtlasOptions& atlas, const std::string& maps) {
  sdm::OptionInfo info = resolution_of(atlas, maps);
  info.text += "; with --atlas uv also WxH, those of a row and of a column";
  info.value = "N|WxH";
  return add_declared_option(app, std::move(info), [&atlas](const std::string& text) {
    const std::size_t by = std::min(text.find('x'), text.size());
    sdm::AtlasOptions side;
    if (!sdm::read_value(kResolution, text.substr(0, by), atlas)) return false;
    if (by == text.size()) return true;
    if (!sdm::read_value(kResolution, text.substr(by + 1), side)) return false;
    atlas.rows = side.resolution;
    return true;
  });
}

void check_layout(const sdm::AtlasOptions& atlas) {
  if (atlas.rows && *atlas.rows != atlas.resolution && atlas.kind != sdm::AtlasKind::uv)
    throw CLI::ValidationError("--resolution", "a map that is not square needs --atlas uv");
}

void add_layout_options(CLI::App& app, sdm::AtlasOptions& atlas) {
  add_declared_options(app, atlas, {"resolution"});
}

void add_engine_option(CLI::App& app, sdm::EngineInfo& engine) {
  std::string help;
  std::vector<std::pair<std::string, sdm::EngineInfo>> choices;
  for (const sdm::EngineInfo& info : sdm::engines()) {
    choices.emplace_back(info.name, info);
    help += (help.empty() ? "" : "; ") + choices.back().first + ": " + std::string(info.summary);
  }
  add_choice<sdm::EngineInfo>(app, "--engine", engine, help, choices);
}

std::shared_ptr<const sdm::Engine> make_engine(const sdm::EngineInfo& engine, const sdm::GlOptions& gl,
                                               const sdm::AtlasOptions& atlas) {
  if (engine.name != "gl") return sdm::make_engine(engine.name);
  (void)sdm::gl_device(std::max(atlas.resolution, atlas.rows.value_or(0)),
                       gl);  // fails before a surface is built
  return sdm::make_gl_engine(gl);
}

void add_color_options(CLI::App& app, sdm::PictureOptions& picture) {
  add_choice(app, "--colormap", picture.colormap,
             "Colormap; sequential: viridis from 0 to one side, and reds to the other one; "
             "auto: viridis if no distance is negative, sequential if little is on one "
             "side of 0, otherwise diverging");
  app.add_option_function<std::vector<double>>(
         "--range",
         [&picture](const std::vector<double>& range) {
           if (!(range[0] < range[1])) throw CLI::ValidationError("--range", "LO must be below HI");
           picture.range = {range[0], range[1]};
         },
         "The distances at the ends of the colour scale; by default up to the 99th percentile of "
         "|distance|, rounded, to both sides of 0 if distances have both signs")
      ->expected(2)
      ->check(any_number())
      ->type_name("LO HI");
}

void add_picture_options(CLI::App& app, sdm::PictureOptions& picture) {
  add_color_options(app, picture);
  app.add_option(
         "--picture-size", picture.largest,
         "The most pixels a side of the pictures and of the model's texture; of a larger map, they show "
         "some texels")
      ->transform(whole_number(16, 32768))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--units", picture.units,
                 "Units of the meshes, for the legend; m, cm, mm, um, in, ft also scale model.glb to metres")
      ->type_name("NAME");
  add_up_option(app, picture.up, "model.glb, views.png and report.html");
  app.add_flag("--unlit", picture.unlit, "model.glb without shading, in exactly the colours of the scale");
}

void add_units_option(CLI::App& app, std::string& units) {
  app.add_option("--units", units, "Units of the meshes, for printed and drawn values")->type_name("NAME");
}

void add_up_option(CLI::App& app, sdm::UpAxis& up, const std::string& files) {
  add_choice(app, "--up", up, "The axis of the meshes that points up, in " + files);
}

void add_tolerance_option(CLI::App& app, std::optional<sdm::Tolerance>& tolerance) {
  app.add_option_function<std::string>(
         "--tolerance", [&tolerance](const std::string& text) { tolerance = parse_tolerance(text); },
         "Draw colour bands, and judge whether all distances are from LO to HI, by the exit code too; T: the "
         "same as "
         "-T:T, also for unsigned distances")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return parse_tolerance(text)
                       ? std::string()
                       : text + " is not a number, 0 or more, nor two numbers LO:HI, the smaller one first";
          },
          ""))
      ->type_name("T|LO:HI");
}

void add_run_options(CLI::App& app, RunOptions& run, const std::string& json_prints) {
  app.add_option("--threads", run.threads, "Threads to use, 0 for all cores")
      ->transform(whole_number(0, 1024))
      ->type_name("N")
      ->capture_default_str();
  if (!json_prints.empty()) app.add_flag("--json", run.json, "Print " + json_prints);
  app.add_flag("--quiet", run.quiet,
               json_prints.empty() ? "Print only errors" : "Print only errors, and the JSON if requested");
}

// Has external linkage, so that the compiler keeps it, and the limit is not a leak.
sdm::ThreadLimit* limit_of_process = nullptr;

void limit_threads(unsigned count) {
  limit_of_process = new sdm::ThreadLimit(count);
}
