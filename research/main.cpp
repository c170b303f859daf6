// The program sdm-paper. Exit codes: 0 success, 1 failure, 2 invalid usage.

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "cli/help_text.h"
#include "cli/interrupts.h"
#include "cli/read_files.h"
#include "cli/terminal_text.h"
#include "cli/usage_error.h"
#include "research/field_command.h"
#include "research/figures_command.h"
#include "research/literal_command.h"

namespace {

/// Returns the exit code.
int run(int argc, char** argv) {
  CLI::App app("Measures the paper that sdm implements, and what else the literature has for it.",
               "sdm-paper");
  app.require_subcommand(1);
  app.formatter(help_formatter(help_width()));
  try {
    add_figures_command(app);
    add_field_command(app);
    add_literal_command(app);
    app.failure_message(usage_error);
    app.parse(arguments(app, argc, argv));
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;  // 0: --help
  } catch (const UnknownCommand& error) {
    std::cerr << "sdm-paper: error: " << printable_lines(error.what()) << '\n';
    return 2;
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Interrupts interrupts;
  try {
    watch_inputs({argv, static_cast<std::size_t>(argc)});
    const PrintableOutput output;
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "sdm-paper: error: " << printable_lines(error.what()) << '\n';
  }
  Interrupts::end();
  return 1;
}
