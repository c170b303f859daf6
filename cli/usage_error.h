// Usage errors: one line in the form of all other errors, with the nearest name of what was not recognised.
#pragma once

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <string>
#include <vector>

struct UnknownCommand : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The message of an error, for CLI::App::failure_message.
[[nodiscard]] std::string usage_error(const CLI::App* app, const CLI::Error& error);

/// The arguments in the order in which CLI::App parses them: the last one first. `sdm help map` becomes `sdm
/// map --help`. Throws UnknownCommand.
[[nodiscard]] std::vector<std::string> arguments(const CLI::App& app, int argc, char** argv);
