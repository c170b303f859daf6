#include "usage_error.h"

#include <sdm/options.h>

#include <algorithm>

#include "terminal_text.h"

namespace {

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

}  // namespace

std::string usage_error(const CLI::App* app, const CLI::Error& error) {
  const std::vector<CLI::App*> commands = app->get_subcommands();
  const CLI::App* command = commands.empty() ? app : commands.front();
  std::string text = app->get_name() + ": error: ";
  if (const std::vector<std::string> extras = command->remaining(true); !extras.empty()) {
    const std::string name = extras.front().substr(0, extras.front().find('='));
    text += name.starts_with('-') ? sdm::unknown_name("option", name, option_names(*command))
                                  : "unexpected argument " + name;
  } else {
    text += error.what();
  }
  return printable_lines(text) + "\nRun " + app->get_name() +
         (command == app ? "" : " " + command->get_name()) + " --help for more information.\n";
}

std::vector<std::string> arguments(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string> all(argv + 1, argv + argc);
  if (!all.empty() && all.front() == "help") {
    all.erase(all.begin());
    all.resize(std::min<std::size_t>(all.size(), 1));
    all.push_back("--help");
  }
  if (!all.empty() && !all.front().starts_with('-'))
    if (const auto names = command_names(app); std::ranges::find(names, all.front()) == names.end())
      throw UnknownCommand(sdm::unknown_name("command", all.front(), names));
  std::ranges::reverse(all);
  return all;
}
