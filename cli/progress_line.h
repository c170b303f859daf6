// Progress on a terminal.
#pragma once

#include <sdm/error.h>
#include <sdm/execution.h>

#include <string>
#include <string_view>
#include <utility>

/// An interrupt after which results have been kept. The message is one sentence that says what and where.
class Interrupted : public sdm::Cancelled {
 public:
  explicit Interrupted(std::string message) : message_(std::move(message)) {}
  [[nodiscard]] const char* what() const noexcept override { return message_.c_str(); }

 private:
  std::string message_;
};

/// A line on stderr that is rewritten, and removed at the end. Shown only if stderr is a terminal.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// The callback refers to this object, which must outlive it. It asks to cancel after an interrupt.
  [[nodiscard]] sdm::Progress callback();
  /// Throws sdm::Cancelled after an interrupt.
  void step(std::string_view name);

 private:
  bool show(std::string line);

  bool visible_;
  std::string shown_;
};
