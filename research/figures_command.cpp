#include "research/figures_command.h"

#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>

#include "cli/common_options.h"
#include "cli/output_folder.h"
#include "cli/progress_line.h"
#include "research/figures/reproduce.h"

namespace {

struct FiguresCommand : RunOptions {
  std::filesystem::path out;
  sdm::figures::Options options;
};

void run(FiguresCommand command) {
  limit_threads(command.threads);
  OutputFolder out(command.out, {.command = "figures", .planned = {"report.json", "report.html"}});
  ProgressLine progress(command.quiet);
  command.options.step = [&](std::string_view name) { progress.step(name); };
  sdm::figures::Reproduction result;
  out.fill([&] {
    result = sdm::figures::reproduce(command.options);
    write_text(out.staging() / "report.html", sdm::figures::report_page(result));
    write_text(out.staging() / "report.json", sdm::figures::report_json(result).dump(1) + '\n');
  });
  if (command.quiet) return;
  for (const sdm::figures::Figure& figure : result.figures)
    std::cout << figure.title << '\n' << "  " << figure.measured << '\n';
  std::cout << fmt::format("{} figures in {:.0f} s, in {}/report.html and report.json\n",
                           result.figures.size(), result.seconds, command.out.string());
}

}  // namespace

void add_figures_command(CLI::App& app) {
  CLI::App* figures = app.add_subcommand(
      "figures", "Re-run the figures and tables of the paper on this machine, with a report");
  const auto command = std::make_shared<FiguresCommand>();
  add_output_option(*figures, command->out);
  figures->add_flag("--quick", command->options.quick,
                    "Fewer frames, lower resolutions, fewer repetitions: seconds instead of minutes");
  figures->add_option("--only", command->options.only, "Only these figures, separated by commas")
      ->delimiter(',')
      ->check(CLI::IsMember(sdm::figures::figure_keys()))
      ->type_name("KEY,...");
  figures
      ->add_option("--mesh", command->options.mesh,
                   "The mesh that stands for the bunny, instead of the one of Debian's glmark2-data")
      ->type_name("FILE");
  add_run_options(*figures, *command);
  figures->footer(
      "Writes report.html, a page that loads nothing, and report.json, with a key for each "
      "figure.\n\nExample:\n  sdm-paper figures -o figures --quick");
  figures->callback([command] { run(*command); });
}
