// Rows of numbers in text.
#pragma once

#include <string>

#include "io/read/text_scanner.h"

namespace sdm::io {

/// Reads rows, each of which begins on a line of its own. A row may continue on further lines if it ends with
/// the last of them, so that no number of one row is taken for one of another. Faults throw sdm::Error with
/// the line number.
class TextRows {
 public:
  explicit TextRows(const TextScanner& in) : in_(in) {}

  [[nodiscard]] TextScanner& scanner() { return in_; }
  [[nodiscard]] const TextScanner& scanner() const { return in_; }
  /// Advances to the next row.
  void begin() {
    in_.next_word();
    start_ = in_.position();
    wrapped_ = false;
  }
  /// Advances to the next word of the row. Returns whether there is one.
  bool next() {
    wrapped_ = wrapped_ || !in_.more_on_line();
    return in_.next_word();
  }
  double number() {
    next();
    return in_.number();
  }
  std::int64_t integer() {
    next();
    return in_.integer();
  }
  /// Ends the row, whose name name() returns. The rest of its line may hold up to `most` further words.
  template <class Name>
  void end(const Name& name, int most = 0) {
    if (wrapped_) most = 0;
    for (int count = 0; in_.more_on_line(); in_.word())
      if (++count > most)
        in_.fail_at(start_, name() + (wrapped_ ? " has fewer" : " has more") +
                                " numbers than the header declares, or is not on a line of its own");
  }

 private:
  TextScanner in_;
  const char* start_ = nullptr;
  bool wrapped_ = false;  // whether the row goes on in another line than it began in
};

}  // namespace sdm::io
