// The commands and their options by name, for the manual page and completions.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

/// The commands that are listed for users.
[[nodiscard]] inline std::vector<const CLI::App*> visible_commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

/// The names of an option, such as "-o" and "--output"; none of an argument.
[[nodiscard]] inline std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

/// The name of the value of an option; empty for a flag.
[[nodiscard]] inline std::string value_of(const CLI::Option& option) {
  return option.get_items_expected_max() == 0 ? std::string() : option.get_type_name();
}
