#include "common_options.h"

#include <sdm/execution.h>
#include <sdm/gl.h>
#include <sdm/gpu.h>

#include <algorithm>
#include <vector>

#include "declared_options.h"
#include "devices.h"
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

constexpr auto kResolution = sdm::option_of(&sdm::AtlasOptions::resolution);

sdm::OptionInfo resolution_of(std::uint32_t usual, const std::string& maps) {
  sdm::OptionInfo info = sdm::info_of(kResolution);
  info.default_value = std::to_string(usual);
  info.text = "Texels along each side of " + maps;
  return info;
}

}  // namespace

CLI::Option* add_side_option(CLI::App& app, sdm::AtlasOptions& atlas, const std::string& maps) {
  return add_declared_option(app, resolution_of(atlas.resolution, maps), [&atlas](const std::string& text) {
    return sdm::read_value(kResolution, text, atlas);
  });
}

CLI::Option* add_resolution_option(CLI::App& app, std::uint32_t& resolution,
                                   std::optional<std::uint32_t>& rows, const std::string& maps) {
  sdm::OptionInfo info = resolution_of(resolution, maps);
  info.text += "; with --atlas uv also WxH, those of a row and of a column";
  info.value = "N|WxH";
  return add_declared_option(app, std::move(info), [&resolution, &rows](const std::string& text) {
    const std::size_t by = std::min(text.find('x'), text.size());
    sdm::AtlasOptions columns, side;
    if (!sdm::read_value(kResolution, text.substr(0, by), columns)) return false;
    resolution = columns.resolution;
    if (by == text.size()) return true;
    if (!sdm::read_value(kResolution, text.substr(by + 1), side)) return false;
    rows = side.resolution;
    return true;
  });
}

CLI::Option* add_resolution_option(CLI::App& app, sdm::AtlasOptions& atlas, const std::string& maps) {
  return add_resolution_option(app, atlas.resolution, atlas.rows, maps);
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
  if (engine.name == "gpu") {
    quiet_vulkan();
    return sdm::make_gpu_engine({.device = gl.device});
  }
  if (engine.name != "gl") return sdm::make_engine(engine.name);
  (void)sdm::gl_device(std::max(atlas.resolution, atlas.rows.value_or(0)),
                       gl);  // fails before a surface is built
  return sdm::make_gl_engine(gl);
}

void add_color_options(CLI::App& app, sdm::PictureOptions& picture) {
  add_declared_options(app, picture, {"tolerance", "units", "size", "up", "unlit"});
}

void add_picture_options(CLI::App& app, sdm::PictureOptions& picture) {
  add_declared_options(
      app, picture, {"tolerance"},
      {{"units",
        "Units of the meshes, for the legend; m, cm, mm, um, in, ft also scale model.glb to metres."},
       {"size", nullptr, "picture_size"},
       {"up", "The axis of the meshes that points up, in model.glb, views.png and report.html."},
       {"unlit", "model.glb without shading, in exactly the colours of the scale."}});
}

void add_units_option(CLI::App& app, std::string& units) {
  add_declared_option(app, sdm::option_of(&sdm::SummaryOptions::units), units);
}

void add_up_option(CLI::App& app, sdm::UpAxis& up, const char* text) {
  add_declared_option(app, sdm::option_of(&sdm::PictureOptions::up), up, {"up", text});
}

void add_tolerance_option(CLI::App& app, std::optional<sdm::Tolerance>& tolerance) {
  add_declared_option(app, sdm::option_of(&sdm::ColorChoice::tolerance), tolerance,
                      {"tolerance",
                       "Draw colour bands, and judge whether all distances are from LO to HI, by the exit "
                       "code too; T: the same as -T:T, also for unsigned distances."});
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
