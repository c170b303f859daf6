// Words and numbers of a text, line by line.
#pragma once

#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace sdm::io {

/// A position in a text. Lines end with LF, CR LF or CR; a backslash at the end of a line joins it with the
/// next; '#' starts a comment. Faults are reported by throwing sdm::Error with the number of the line.
class TextScanner {
 public:
  explicit TextScanner(std::string_view text)
      : begin_(text.data()), at_(begin_), end_(begin_ + text.size()), newline_(line_end(text)) {}

  [[nodiscard]] bool at_end() const { return at_ == end_; }
  /// Bytes that are left.
  [[nodiscard]] std::size_t remaining() const { return static_cast<std::size_t>(end_ - at_); }
  [[nodiscard]] const char* position() const { return at_; }

  /// To the start of the next line.
  void skip_line() {
    const void* found = std::memchr(at_, newline_, remaining());
    at_ = found ? static_cast<const char*>(found) + 1 : end_;
  }
  /// To the next word, over any number of lines and comments; whether there is one.
  bool next_word() {
    while (!more_on_line()) {
      if (at_end()) return false;
      skip_line();
    }
    return true;
  }
  /// To the next word of this line; whether there is one.
  bool more_on_line() {
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

  /// Whether a word goes on here.
  [[nodiscard]] bool in_word() const { return at_ != end_ && !is_delimiter(*at_); }
  /// The word here: at least one character, and all up to the next blank; empty at the end of the text.
  std::string_view word() {
    const char* start = at_;
    if (at_ != end_) ++at_;
    while (in_word()) ++at_;
    return {start, static_cast<std::size_t>(at_ - start)};
  }
  /// Steps over `expected` if it is the whole word here.
  bool accept(std::string_view expected) {
    if (remaining() < expected.size() || std::memcmp(at_, expected.data(), expected.size()) != 0)
      return false;
    if (remaining() > expected.size() && !is_delimiter(at_[expected.size()])) return false;
    at_ += expected.size();
    return true;
  }
  /// Steps over a character if it is next.
  bool accept(char expected) {
    if (at_ == end_ || *at_ != expected) return false;
    ++at_;
    return true;
  }
  /// The number next on this line.
  double number() {
    if (!more_on_line()) fail_at_word("a number is needed");
    return parse_number();
  }
  /// The number next in the text, over any number of lines.
  double number_across_lines() {
    if (!next_word()) fail_at_word("a number is needed");
    return parse_number();
  }
  /// The whole number next on this line; '/' may follow.
  std::int64_t integer() {
    if (!more_on_line()) fail_at_word("a whole number is needed");
    std::int64_t value = 0;
    const auto [stop, error] = std::from_chars(at_, end_, value);
    if (error != std::errc{} || (stop != end_ && *stop != '/' && !is_delimiter(*stop)))
      fail_at_word("a whole number is needed");
    at_ = stop;
    return value;
  }

  [[noreturn]] void fail(const std::string& fault) const { fail_at(at_, fault); }
  /// Throws with the line of `position`.
  [[noreturn]] void fail_at(const char* position, const std::string& fault) const;
  /// Throws with the word here, and says so where the text ends.
  [[noreturn]] void fail_at_word(const std::string& fault);

 private:
  static char line_end(std::string_view text) {
    const std::size_t first = text.find_first_of("\r\n");
    return first != std::string_view::npos && text[first] == '\r' && text.substr(first, 2) != "\r\n" ? '\r'
                                                                                                     : '\n';
  }
  static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  static bool is_delimiter(char c) { return is_blank(c) || c == '#' || c == '\\'; }

  // At a backslash: steps onto the end of its line if nothing else follows.
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
    if (error != std::errc{} || (stop != end_ && !is_delimiter(*stop))) fail_at_word("a number is needed");
    at_ = stop;
    return value;
  }

  const char* begin_;
  const char* at_;
  const char* end_;
  char newline_;
};

}  // namespace sdm::io
