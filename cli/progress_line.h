// Progress on a terminal, and a clean end on Ctrl-C.
#pragma once

#include <sdm/progress.h>

#include <string>
#include <string_view>

/// One line on stderr that is rewritten, and removed at the end. Shown only where stderr is a terminal. While
/// it lives, the first interrupt (Ctrl-C, SIGTERM or SIGHUP) cancels the work, and the second one ends the
/// program.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Refers to this object.
  [[nodiscard]] sdm::Progress callback();
  /// Throws sdm::Cancelled after an interrupt.
  void step(std::string_view name);
  /// Once all is tidied up after an interrupt: ends the program by that very signal, so that a shell ends its
  /// loop too.
  static void end_by_interrupt();

 private:
  bool show(std::string_view step, double fraction);

  bool visible_;
  std::string shown_;
};
