#include "usage_error.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "terminal_text.h"

namespace {

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

}  // namespace

std::string usage_error(const CLI::App* app, const CLI::Error& error) {
  const std::vector<CLI::App*> commands = app->get_subcommands();
  const CLI::App* command = commands.empty() ? app : commands.front();
  std::string text = app->get_name() + ": error: ";
  if (const std::vector<std::string> extras = command->remaining(true); !extras.empty()) {
    const std::string& name = extras.front();
    text += name.starts_with('-') ? "unknown option " + name + suggestion(name, option_names(*command))
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
      throw UnknownCommand("unknown command " + all.front() + suggestion(all.front(), names));
  std::ranges::reverse(all);
  return all;
}
