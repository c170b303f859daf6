#include "io/points/text/text_lines.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <cstring>

namespace sdm::io {
namespace {

constexpr std::size_t kBuffer = std::size_t{1} << 18;
static_assert(kBuffer > 2 * kMaxLine);

std::string_view without_return(std::string_view line) {
  while (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

}  // namespace

char line_end_of(std::string_view text) {
  const std::size_t first = text.find_first_of("\r\n");
  const bool lone = first != std::string_view::npos && text[first] == '\r' && text.substr(first, 2) != "\r\n";
  return lone ? '\r' : '\n';
}

std::string_view take_line(std::string_view& text, char line_end) {
  const std::size_t end = std::min(text.find(line_end), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return without_return(line);
}

std::string quoted(std::string_view text) {
  std::string result = "'";
  for (const char c : text.substr(0, 32)) result += c < ' ' || c > '~' ? '?' : c;
  return result + (text.size() > 32 ? "...'" : "'");
}

TextLines::TextLines(std::ifstream& stream, char line_end, std::uint64_t first_number)
    : stream_(stream), buffer_(kBuffer), number_(first_number - 1), line_end_(line_end) {}

std::optional<std::string_view> TextLines::next() {
  const auto find_end = [this](std::size_t from) {
    return static_cast<const char*>(std::memchr(buffer_.data() + from, line_end_, end_ - from));
  };
  const char* end = find_end(begin_);
  if (!end) {
    const std::size_t searched = end_ - begin_;
    refill();
    end = find_end(searched);
  }
  if (!end && begin_ == end_) return std::nullopt;
  ++number_;
  const char* const first = buffer_.data() + begin_;
  const auto length = static_cast<std::size_t>((end ? end : buffer_.data() + end_) - first);
  if (length > kMaxLine) fail(kLongLine);
  begin_ += std::min(length + 1, end_ - begin_);
  return without_return({first, length});
}

void TextLines::fail(std::string_view fault) const {
  throw Error(fmt::format("line {}: {}", number_, fault));
}

// Fills the buffer, with what is left at its front. A line that does not end in a full buffer is too long.
void TextLines::refill() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  stream_.read(buffer_.data() + end_, static_cast<std::streamsize>(buffer_.size() - end_));
  end_ += static_cast<std::size_t>(stream_.gcount());
  if (stream_.bad()) throw Error("cannot be read");
}

}  // namespace sdm::io
