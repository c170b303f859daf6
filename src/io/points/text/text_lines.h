// The lines of a text of any size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sdm::io {

/// A longer line is an error.
inline constexpr std::size_t kMaxLine = std::size_t{1} << 16;
inline constexpr std::string_view kLongLine = "is longer than 65536 bytes; it is damaged or not a text";

/// The character that ends the lines: '\r' if the first line ends with it alone, else '\n', before which a
/// '\r' does not belong to the line.
[[nodiscard]] char line_end_of(std::string_view text);

/// Removes the first line from a text and returns it, without its end.
[[nodiscard]] std::string_view take_line(std::string_view& text, char line_end);

/// What a message quotes of a text: at most 32 characters, those that are not printable ASCII as '?'.
[[nodiscard]] std::string quoted(std::string_view text);

/// Reads a stream from its current position line by line. Memory: a buffer of 256 KiB.
class TextLines {
 public:
  TextLines(std::ifstream& stream, char line_end, std::uint64_t first_number);

  /// The next line, without its end, valid until the next call; nothing at the end of the text.
  std::optional<std::string_view> next();
  /// The number of the last line.
  [[nodiscard]] std::uint64_t number() const { return number_; }
  /// Throws sdm::Error with the number of the last line.
  [[noreturn]] void fail(std::string_view fault) const;

 private:
  void refill();

  std::ifstream& stream_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // what is left in the buffer
  std::uint64_t number_;
  char line_end_;
};

}  // namespace sdm::io
