#include "progress_line.h"

#include <sdm/error.h>
#include <unistd.h>

#include <csignal>
#include <iostream>

namespace {

volatile std::sig_atomic_t interrupted = 0;

extern "C" void interrupt(int signal) {
  interrupted = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

ProgressLine::ProgressLine(bool quiet) : visible_(!quiet && isatty(STDERR_FILENO) != 0) {
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
}

ProgressLine::~ProgressLine() {
  if (!shown_.empty()) std::cerr << "\r\033[K" << std::flush;
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

sdm::Progress ProgressLine::callback() {
  return [this](std::string_view step, double fraction) { return show(step, fraction); };
}

void ProgressLine::step(std::string_view name) {
  if (!show(name, 0)) throw sdm::Cancelled();
}

bool ProgressLine::show(std::string_view step, double fraction) {
  if (visible_) {
    std::string line(step);
    line.append(" ").append(std::to_string(static_cast<int>(100 * fraction))).append(" %");
    if (line != shown_) std::cerr << "\r\033[K" << (shown_ = line) << std::flush;
  }
  return interrupted == 0;
}
