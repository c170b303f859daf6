// The sdm command. Exit codes: 0 success, 1 failure, 2 invalid usage, 3 tolerance exceeded.
#include "bodies.h"
#include "devices.h"
#include "info.h"
#include "map.h"
#include "progress_line.h"
#include "proximity.h"
#include "scene.h"
#include "self.h"
#include "sequence.h"

#include <sdm/error.h>
#include <sdm/version.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <new>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

void flush_output() {
  if (!std::cout.flush()) throw sdm::Error("cannot write to standard output; the disk may be full");
}

struct UnknownCommand : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The option that remedies the error, as text for its message.
std::string advice(sdm::Remedy remedy) {
  switch (remedy) {
    case sdm::Remedy::none:
      break;
    case sdm::Remedy::atlas_kind:
      return " (--atlas charts)";
    case sdm::Remedy::resolution:
      return " (--resolution)";
    case sdm::Remedy::sign_method:
      return " (--sign)";
  }
  return {};
}

// The number of characters to insert, delete or replace to make one text the other.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j)
      diagonal =
          std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])}));
  }
  return row.back();
}

/// "; did you mean X?" with the nearest of some names, or nothing if none is near.
std::string suggestion(const std::string& name, const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 2;
  const auto nearest = std::ranges::min_element(
      names, {}, [&](const std::string& other) { return edit_distance(name, other); });
  if (nearest == names.end() || edit_distance(name, *nearest) > kMost) return {};
  return "; did you mean " + *nearest + "?";
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// A usage error in one line, with the nearest name of what was not recognised.
std::string usage_error(const CLI::App* app, const CLI::Error& error) {
  const std::vector<CLI::App*> commands = app->get_subcommands();
  const CLI::App* command = commands.empty() ? app : commands.front();
  std::string text = "sdm: error: ";
  if (const std::vector<std::string> extras = command->remaining(true); !extras.empty()) {
    const std::string& name = extras.front();
    text += name.starts_with('-') ? "unknown option " + name + suggestion(name, option_names(*command))
                                  : "unexpected argument " + name;
  } else {
    text += error.what();
  }
  return text + "\nRun " + (command == app ? "sdm" : "sdm " + command->get_name()) +
         " --help for more information.\n";
}

/// The arguments in the order in which CLI11 parses them: the last one first. `sdm help map` is `sdm map
/// --help`.
std::vector<std::string> arguments(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string> all(argv + 1, argv + argc);
  if (!all.empty() && all.front() == "help") {
    all.erase(all.begin());
    all.resize(std::min<std::size_t>(all.size(), 1));
    all.push_back("--help");
  }
  if (!all.empty() && !all.front().starts_with('-'))
    if (const auto names = command_names(app); std::ranges::find(names, all.front()) == names.end())
      throw UnknownCommand("unknown command " + all.front() + suggestion(all.front(), names));
  std::ranges::reverse(all);
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Computes surface distance maps: the distance from every point of one triangle mesh to another.",
      "sdm");
  app.set_version_flag("--version", std::string("sdm ") + sdm::kVersion);
  app.require_subcommand(0, 1);
  app.footer(
      "Example:\n"
      "  sdm map scan.ply part.stl -o out --units mm\n"
      "  sdm map --help");
  try {
    add_map_command(app);
    add_proximity_command(app);
    add_bodies_command(app);
    add_sequence_command(app);
    add_self_command(app);
    add_info_command(app);
    add_devices_command(app);
    add_scene_command(app);
    app.failure_message(usage_error);
    app.parse(arguments(app, argc, argv));
    if (app.get_subcommands().empty()) std::cout << app.help();
    flush_output();
    return 0;
  } catch (const CLI::RuntimeError& outcome) {
    return outcome.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;  // 0: --help and --version
  } catch (const UnknownCommand& error) {
    std::cerr << "sdm: error: " << error.what() << "\nRun sdm --help for the list of commands.\n";
    return 2;
  } catch (const sdm::Cancelled& error) {
    std::cerr << "sdm: error: " << error.what() << '\n';
    ProgressLine::end_by_interrupt();
  } catch (const std::bad_alloc&) {
    std::cerr << "sdm: error: not enough memory; choose a lower --resolution or smaller meshes\n";
  } catch (const sdm::Error& error) {
    std::cerr << "sdm: error: " << error.what() << advice(error.remedy()) << '\n';
  } catch (const std::exception& error) {
    std::cerr << "sdm: error: " << error.what() << '\n';
  }
  return 1;
}
