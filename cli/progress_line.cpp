#include "progress_line.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <unistd.h>

#include <iostream>
#include <utility>

#include "interrupts.h"
#include "src/core/printable.h"

ProgressLine::ProgressLine(bool quiet) : visible_(!quiet && isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() {
  if (!shown_.empty()) std::cerr << "\r\033[K" << std::flush;
}

sdm::Progress ProgressLine::callback() {
  return [this](std::string_view step, double fraction) {
    return show(fmt::format("{} {} %", step, static_cast<int>(100 * fraction)));
  };
}

void ProgressLine::step(std::string_view name) {
  if (!show(std::string(name))) throw sdm::Cancelled();
}

bool ProgressLine::show(std::string line) {
  line = sdm::printable(line);
  if (visible_ && line != shown_) std::cerr << "\r\033[K" << (shown_ = std::move(line)) << std::flush;
  return !Interrupts::received();
}
