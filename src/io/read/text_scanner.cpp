#include "io/read/text_scanner.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>

namespace sdm::io {

std::int64_t TextScanner::line_of(const char* position) const {
  return 1 + std::count(begin_, position, newline_);
}

void TextScanner::fail_at(const char* position, std::string_view fault) const {
  throw Error(fmt::format("line {}: {}", line_of(position), fault));
}

void TextScanner::fail_at_word(std::string_view fault) {
  const char* start = at_;
  std::string found(in_word() ? word().substr(0, 32) : std::string_view());
  for (char& c : found)
    if (c < ' ' || c > '~') c = '?';
  fail_at(start, fmt::format("{}{}{}", fault, found.empty() ? "" : fmt::format(", not '{}'", found),
                             at_end() ? "; the text ends here, so the file may be truncated" : ""));
}

}  // namespace sdm::io
