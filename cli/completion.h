// Completions for shells, and the manual page, from the tree of commands and options.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

/// `sdm completion bash|zsh|fish`, which the help does not list. `app` must outlive the parsing.
void add_completion_command(CLI::App& app);

/// The manual page in section 1, for man.
[[nodiscard]] std::string manual_page(const CLI::App& app);
