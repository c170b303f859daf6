// The end of a command: JSON or text.
#pragma once

#include <iostream>
#include <string>

#include "common_options.h"
#include "patience.h"
#include "report.h"
#include "terminal_text.h"

/// Prints what `report` returns, as JSON, or else, unless quiet, what `text` returns.
template <class Report, class Text>
void print(const RunOptions& run, const Report& report, const Text& text) {
  if (run.json)
    std::cout << patiently([&] { return to_text(report()); });
  else if (!run.quiet)
    print_for_people(patiently([&]() -> std::string { return text(); }));
}
