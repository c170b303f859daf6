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

  /// The callback refers to this object.
  [[nodiscard]] sdm::Progress callback();
  /// Throws sdm::Cancelled after an interrupt.
  void step(std::string_view name);
  /// After an interrupt and the cleanup that follows it: ends the program by that signal, so that the loop
  /// of a shell script ends too.
  static void end_by_interrupt();

 private:
  bool show(std::string_view step, double fraction);

  bool visible_;
  std::string shown_;
};
