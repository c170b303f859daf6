#include "paper.h"

#include "common_options.h"
#include "option_checks.h"
#include "output_folder.h"
#include "progress_line.h"

#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "paper/reproduce.h"

namespace {

struct PaperCommand {
  std::filesystem::path out;
  sdm::paper::Options options;
  unsigned threads = 0;
  bool quiet = false;
};

void run(PaperCommand command) {
  limit_threads(command.threads);
  OutputFolder out(command.out, [] {
    return std::vector<std::filesystem::path>{"report.json", "report.html"};
  });
  ProgressLine progress(command.quiet);
  command.options.step = [&](std::string_view name) { progress.step(name); };
  sdm::paper::Reproduction result;
  out.fill([&] {
    result = sdm::paper::reproduce(command.options);
    write_text(out.staging() / "report.html", sdm::paper::report_page(result));
    write_text(out.staging() / "report.json", sdm::paper::report_json(result).dump(1) + '\n');
  });
  if (command.quiet) return;
  for (const sdm::paper::Figure& figure : result.figures)
    std::cout << figure.title << '\n' << "  " << figure.measured << '\n';
  std::cout << fmt::format("{} figures in {:.0f} s, in {}/report.html and report.json\n",
                           result.figures.size(), result.seconds, command.out.string());
}

}  // namespace

void add_paper_command(CLI::App& app) {
  CLI::App* paper = app.add_subcommand(
      "paper", "Re-run the figures and tables of the paper on this machine, with a report");
  const auto command = std::make_shared<PaperCommand>();
  add_output_option(*paper, command->out);
  paper->add_flag("--quick", command->options.quick,
                  "Fewer frames, lower resolutions, fewer repetitions: seconds instead of minutes");
  paper->add_option("--only", command->options.only, "Only these figures, separated by commas")
      ->delimiter(',')
      ->check(CLI::IsMember(sdm::paper::figure_keys()))
      ->type_name("KEY,...");
  paper
      ->add_option("--mesh", command->options.mesh,
                   "The mesh that stands for the bunny, instead of the one of Debian's glmark2-data")
      ->type_name("FILE");
  paper->add_option("--threads", command->threads, "Threads to use, 0 for all cores")
      ->transform(whole_number(0, 1024))
      ->type_name("N")
      ->capture_default_str();
  paper->add_flag("--quiet", command->quiet, "Print only errors");
  paper->footer(
      "Writes report.html, a page that loads nothing, and report.json, with a key for each "
      "figure.\n\nExample:\n  sdm paper -o paper --quick");
  paper->callback([command] { run(*command); });
}
