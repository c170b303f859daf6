// Words, numbers and rows of numbers in text.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "core/cancellation.h"

namespace sdm::io {

/// Returns whether a word is this one in lower case, but for the case of ASCII letters.
[[nodiscard]] inline bool same_word(std::string_view word, std::string_view lower_case) {
  return std::equal(word.begin(), word.end(), lower_case.begin(), lower_case.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

/// Reads text from front to back. Lines end with LF, CR LF or CR; a backslash at the end of a line joins it
/// with the next; '#' starts a comment. Faults throw sdm::Error with the line number.
class TextScanner {
 public:
  /// Reads `text` from the byte `start` on; lines are counted from its beginning.
  explicit TextScanner(std::string_view text, std::size_t start = 0)
      : begin_(text.data()), at_(begin_ + start), end_(begin_ + text.size()), newline_(line_end(text)) {}

  [[nodiscard]] bool at_end() const { return at_ == end_; }
  /// Returns the number of bytes left.
  [[nodiscard]] std::size_t remaining() const { return static_cast<std::size_t>(end_ - at_); }
  [[nodiscard]] const char* position() const { return at_; }

  /// Advances to the start of the next line.
  void skip_line() {
    const void* found = std::memchr(at_, newline_, remaining());
    at_ = found ? static_cast<const char*>(found) + 1 : end_;
  }
  /// Advances to the next word, past any line ends and comments. Returns whether there is one.
  bool next_word() {
    while (!more_on_line()) {
      if (at_end()) return false;
      skip_line();
    }
    return true;
  }
  /// Advances to the next word on this line. Returns whether there is one.
  bool more_on_line() {
    due_();
    for (; at_ != end_; ++at_) {
      if (*at_ == newline_ || *at_ == '#') return false;
      if (*at_ == '\\') {
        if (!join_lines()) return true;
      } else if (!is_blank(*at_)) {
        return true;
      }
    }
    return false;
  }

  /// Returns whether the next character is part of a word.
  [[nodiscard]] bool in_word() const { return at_ != end_ && !is_delimiter(*at_); }
  /// Reads a word: at least one character, and all others up to the next blank. Empty at the end of the text.
  std::string_view word() {
    const char* start = at_;
    if (at_ != end_) ++at_;
    while (in_word()) ++at_;
    return {start, static_cast<std::size_t>(at_ - start)};
  }
  /// Reads up to the end of the line, without blanks there: the name of a file, of which blanks, a backslash
  /// and '#' may be part.
  std::string_view rest_of_line() {
    const void* found = std::memchr(at_, newline_, remaining());
    const char* const start = at_;
    at_ = found ? static_cast<const char*>(found) : end_;
    std::string_view text(start, static_cast<std::size_t>(at_ - start));
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
  }
  /// Skips the next word if it is `expected`. Returns whether it is.
  bool accept(std::string_view expected) {
    if (remaining() < expected.size() || std::memcmp(at_, expected.data(), expected.size()) != 0)
      return false;
    if (remaining() > expected.size() && !is_delimiter(at_[expected.size()])) return false;
    at_ += expected.size();
    return true;
  }
  /// Skips the next character if it is `expected`. Returns whether it is.
  bool accept(char expected) {
    if (at_ == end_ || *at_ != expected) return false;
    ++at_;
    return true;
  }
  /// Reads the next number on this line.
  double number() {
    if (!more_on_line()) fail_at_word("expected a number");
    return parse_number();
  }
  /// Reads the next number, on this line or a later one.
  double number_across_lines() {
    if (!next_word()) fail_at_word("expected a number");
    return parse_number();
  }
  /// Reads the next integer on this line; '/' may follow it.
  std::int64_t integer() {
    if (!more_on_line()) fail_at_word("expected a whole number");
    std::int64_t value = 0;
    const auto [stop, error] = std::from_chars(at_, end_, value);
    if (error != std::errc{} || (stop != end_ && *stop != '/' && !is_delimiter(*stop)))
      fail_at_word("expected a whole number");
    at_ = stop;
    return value;
  }

  /// Returns the number of the line of `position`, from 1. Cost: linear.
  [[nodiscard]] std::int64_t line_of(const char* position) const;
  [[noreturn]] void fail(std::string_view fault) const { fail_at(at_, fault); }
  /// Throws with the line number of `position`.
  [[noreturn]] void fail_at(const char* position, std::string_view fault) const;
  /// Throws with the next word in the message, and notes if the text ends there.
  [[noreturn]] void fail_at_word(std::string_view fault);

 private:
  static char line_end(std::string_view text) {
    const std::size_t first = text.find_first_of("\r\n");
    return first != std::string_view::npos && text[first] == '\r' && text.substr(first, 2) != "\r\n" ? '\r'
                                                                                                     : '\n';
  }
  static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  static bool is_delimiter(char c) { return is_blank(c) || c == '#' || c == '\\'; }

  // Advances from a backslash to the end of the line if nothing else follows.
  bool join_lines() {
    const char* next = at_ + 1;
    if (next != end_ && *next == '\r' && newline_ == '\n') ++next;
    if (next == end_ || *next != newline_) return false;
    at_ = next;
    return true;
  }
  double parse_number() {
    const char* start = at_ + (*at_ == '+');
    double value = 0;
    const auto [stop, error] = std::from_chars(start, end_, value);
    if (error != std::errc{} || (stop != end_ && !is_delimiter(*stop))) fail_at_word("expected a number");
    at_ = stop;
    return value;
  }

  const char* begin_;
  const char* at_;
  const char* end_;
  char newline_;
  Poll due_{1 << 14};  // words
};

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
