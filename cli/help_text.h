// Help that fits the terminal.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

/// The text with its lines broken at blanks, so that none is longer than `width` characters if its words are
/// not; lines that begin with a blank, such as examples, stay as they are. Further lines begin with `indent`
/// blanks.
[[nodiscard]] std::string wrapped(std::string_view text, std::size_t width, std::size_t indent = 0);

/// The columns of the terminal that standard output is; otherwise those of the environment variable COLUMNS,
/// or 80. At least 40 and at most 120.
[[nodiscard]] std::size_t help_width();

/// The formatter of the command, to be set before subcommands are added.
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> help_formatter(std::size_t width);
