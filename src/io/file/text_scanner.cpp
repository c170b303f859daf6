#include "io/file/text_scanner.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>

#include "core/excerpt.h"

namespace sdm::io {

std::int64_t TextScanner::line_of(const char* position) const {
  return 1 + std::count(begin_, position, newline_);
}

void TextScanner::fail_at(const char* position, std::string_view fault) const {
  throw Error(fmt::format("line {}: {}", line_of(position), fault));
}

void TextScanner::fail_at_word(std::string_view fault) {
  const char* start = at_;
  const std::string found = excerpt(in_word() ? word() : std::string_view());
  fail_at(start, fmt::format("{}{}{}", fault, found.empty() ? "" : fmt::format(", not '{}'", found),
                             at_end() ? "; the text ends here, so the file may be truncated" : ""));
}

}  // namespace sdm::io
