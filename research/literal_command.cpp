#include "research/literal_command.h"
#include "gl/raster_report.h"

#include <fmt/format.h>
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/common_options.h"
#include "cli/option_checks.h"
#include "cli/output_folder.h"
#include "cli/print.h"
#include "cli/progress_line.h"
#include "cli/report.h"
#include "research/figures/corrections.h"
#include "research/literal/literal_engine.h"

namespace {

using Json = nlohmann::ordered_json;
using sdm::literal::Corrections;

constexpr std::pair<const char*, bool Corrections::*> kNames[] = {
    {"region-walls", &Corrections::region_walls},
    {"affine-vectors", &Corrections::affine_vectors},
    {"fragment-vectors", &Corrections::fragment_vectors},
    {"margins", &Corrections::margins},
    {"tiles", &Corrections::tiles},
    {"stencil-points", &Corrections::stencil_points},
    {"confirmation", &Corrections::confirmation}};

struct Command : RunOptions {
  std::string o1, o2, transform_o1, transform_o2;
  std::filesystem::path out;
  sdm::AtlasOptions atlas;
  sdm::GlOptions gl;
  std::vector<std::string> with;
};

std::vector<std::string> correction_names() {
  std::vector<std::string> names;
  for (const auto& [name, member] : kNames) names.emplace_back(name);
  return names;
}

Corrections corrections_of(const Command& command) {
  Corrections corrections = Corrections::none();
  for (const std::string& wanted : command.with)
    for (const auto& [name, member] : kNames)
      if (wanted == name) corrections.*member = true;
  return corrections;
}

Json report_of(const Command& command, const sdm::Surface& surface, const sdm::figures::MapErrors& errors,
               const sdm::gl::RasterReport& gl) {
  return {{"version", sdm::kVersion},
          {"o1", command.o1},
          {"o2", command.o2},
          {"corrections", command.with},
          {"resolution", surface.resolution()},
          {"texels", gl.texels},
          {"errors",
           {{"wrong_percent", errors.wrong},
            {"none_percent", errors.none},
            {"largest", errors.largest},
            {"mean", errors.mean}}},
          {"raster",
           {{"device", gl.device.name},
            {"sites", gl.sites},
            {"tiles", gl.tiles},
            {"pairs", gl.pairs},
            {"culled_by_bound", gl.culled_by_bound},
            {"culled_by_obb", gl.culled_by_obb},
            {"clipped_away", gl.clipped_away},
            {"polygons", gl.polygons},
            {"unconfirmed", gl.unconfirmed},
            {"stencil_lookups", gl.stencil_lookups},
            {"stencil_hits", gl.stencil_hits},
            {"stencil_evictions", gl.stencil_evictions}}}};
}

void run(const Command& command) {
  limit_threads(command.threads);
  OutputFolder out(command.out, {.command = "literal", .planned = {"report.json", "map.exr"}});
  ProgressLine progress(command.quiet);
  Json report;
  out.fill([&] {
    progress.step("import");
    const sdm::Surface surface(load_input("o1", command.o1, command.transform_o1).mesh, command.atlas);
    const sdm::Sites sites(load_input("o2", command.o2, command.transform_o2).mesh);
    sdm::MapOptions options{.engine = sdm::literal::make_engine(command.gl, corrections_of(command)),
                            .sign = sdm::SignMethod::none,
                            .progress = progress.callback()};
    const sdm::DistanceMap map = compute_map(surface, sites, options);
    const sdm::gl::RasterReport gl = sdm::literal::report(*options.engine).value();
    options.engine = sdm::make_engine("reference");
    const sdm::DistanceMap reference = compute_map(surface, sites, options);
    report = report_of(command, surface, sdm::figures::errors_of(map, reference, surface, sites), gl);
    progress.step("output");
    sdm::write_exr(out.staging() / "map.exr", surface, map);
    write_text(out.staging() / "report.json", to_text(report));
  });
  print(
      command, [&] { return report; },
      [&] {
        const Json& errors = report["errors"];
        return fmt::format(
            "{:.3g} % of {} texels are wrong, {:.3g} % have no value; the largest error is {:.3g} of the "
            "diagonal of both meshes\nin {}/map.exr and report.json\n",
            errors["wrong_percent"].get<double>(), report["texels"].get<std::uint64_t>(),
            errors["none_percent"].get<double>(), errors["largest"].get<double>(), command.out.string());
      });
}

}  // namespace

void add_literal_command(CLI::App& app) {
  CLI::App* literal = app.add_subcommand(
      "literal", "Compute a map by the paper's algorithm as it is printed, and its errors");
  literal->footer(
      "The map is an estimate of unknown accuracy, unsigned, and texels may have no value. `errors` of "
      "report.json compares it with the reference engine.\n\nExample:\n"
      "  sdm-paper literal o1.off o2.off -o literal --with tiles,stencil-points");
  const auto command = std::make_shared<Command>();
  Command& c = *command;
  literal->add_option("O1", c.o1, "The mesh that carries the map")->required();
  literal->add_option("O2", c.o2, "The mesh that distances are measured to")->required();
  add_output_option(*literal, c.out);
  add_transform_option(*literal, "--transform-o1", "O1", c.transform_o1);
  add_transform_option(*literal, "--transform-o2", "O2", c.transform_o2);
  add_side_option(*literal, c.atlas, "the map");
  literal->add_option("--with", c.with, "Corrections to make")
      ->delimiter(',')
      ->check(CLI::IsMember(correction_names()))
      ->type_name("NAME,...");
  literal
      ->add_option("--gl-device", c.gl.device,
                   "The device, by its number in `sdm devices` or part of its name")
      ->type_name("NAME");
  literal->add_option("--stencil-values", c.gl.stencil_values, "The number of stencil values")
      ->transform(whole_number(1, 255))
      ->type_name("K")
      ->capture_default_str();
  literal->add_flag_callback(
      "--no-bound-culling", [&c] { c.gl.bound_culling = false; },
      "Do not cull sites by upper bounds on the distance");
  add_run_options(*literal, c, "the report (report.json) instead of a summary");
  literal->callback([command] { run(*command); });
}
