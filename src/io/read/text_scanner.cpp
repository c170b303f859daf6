#include "io/read/text_scanner.h"

#include <sdm/error.h>

#include <algorithm>

namespace sdm::io {

void TextScanner::fail_at(const char* position, const std::string& fault) const {
  throw Error("line " + std::to_string(1 + std::count(begin_, position, newline_)) + ": " + fault);
}

void TextScanner::fail_at_word(const std::string& fault) {
  const char* start = at_;
  std::string found(in_word() ? word().substr(0, 32) : std::string_view());
  for (char& c : found)
    if (c < ' ' || c > '~') c = '?';
  if (!found.empty()) found = ", not '" + found + "'";
  if (at_end()) found += "; the text ends here, so that the file seems truncated";
  fail_at(start, fault + found);
}

}  // namespace sdm::io
