#include "progress_line.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/printable.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <iostream>
#include <utility>

namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
volatile std::sig_atomic_t interrupted_by = 0;

extern "C" void interrupt(int signal) {
  interrupted_by = signal;
  std::signal(signal, SIG_DFL);
}

}  // namespace

ProgressLine::ProgressLine(bool quiet) : visible_(!quiet && isatty(STDERR_FILENO) != 0) {
  for (const int signal : kSignals)
    if (std::signal(signal, interrupt) == SIG_IGN) std::signal(signal, SIG_IGN);  // under nohup, for example
}

ProgressLine::~ProgressLine() {
  if (!shown_.empty()) std::cerr << "\r\033[K" << std::flush;
  for (const int signal : kSignals)
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
}

bool ProgressLine::interrupted() {
  return interrupted_by != 0;
}

void ProgressLine::end_by_interrupt() {
  if (interrupted_by != 0) std::raise(interrupted_by);
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
  return interrupted_by == 0;
}
