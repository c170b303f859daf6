#include "command_line.h"

#include "bake.h"
#include "bodies.h"
#include "completion.h"
#include "declared_options.h"
#include "devices.h"
#include "exit_codes.h"
#include "hausdorff.h"
#include "help_text.h"
#include "info.h"
#include "map.h"
#include "metrics.h"
#include "points.h"
#include "proximity.h"
#include "scene.h"
#include "self.h"
#include "sequence.h"
#include "simplify.h"
#include "terminal_text.h"
#include "thickness.h"
#include "usage_error.h"
#include "volume.h"

#include <sdm/error.h>
#include <sdm/version.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <string_view>

namespace {

void flush_output() {
  if (!std::cout.flush()) throw sdm::Error("cannot write to standard output; the disk may be full");
}

}  // namespace

int run_command_line(int argc, char** argv) {
  CLI::App app(
      "Computes surface distance maps: the distance from every point of one triangle mesh to another.",
      "sdm");
  app.set_version_flag("--version", std::string("sdm ") + sdm::kVersion);
  app.require_subcommand(0, 1);
  app.formatter(help_formatter(help_width()));
  app.footer(
      "Example:\n"
      "  sdm map scan.ply part.stl -o out --units mm\n"
      "  sdm map --help");
  try {
    add_map_command(app);
    add_points_command(app);
    add_proximity_command(app);
    add_hausdorff_command(app);
    add_metrics_command(app);
    add_bodies_command(app);
    add_sequence_command(app);
    add_self_command(app);
    add_thickness_command(app);
    add_bake_command(app);
    add_volume_command(app);
    add_simplify_command(app);
    add_info_command(app);
    add_devices_command(app);
    add_scene_command(app);
    add_completion_command(app);
    for (CLI::App* command : app.get_subcommands({}))
      command->parse_complete_callback([command] { check_declared_options(*command); });
    app.failure_message(usage_error);
    if (argc == 3 && std::string_view(argv[1]) == "help" && std::string_view(argv[2]) == "--man") {
      std::cout << manual_page(app);
      flush_output();
      return kSuccess;
    }
    app.parse(arguments(app, argc, argv));
    if (app.get_subcommands().empty()) std::cout << app.help();
    flush_output();
    return kSuccess;
  } catch (const CLI::RuntimeError& outcome) {
    return outcome.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kSuccess : kInvalidUsage;  // 0: --help and --version
  } catch (const UnknownCommand& error) {
    std::cerr << "sdm: error: " << printable_lines(error.what())
              << "\nRun sdm --help for the list of commands.\n";
    return kInvalidUsage;
  }
}
