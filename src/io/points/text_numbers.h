// Numbers in a line of text.
#pragma once

#include <charconv>
#include <string_view>
#include <vector>

namespace sdm::io {

/// Replaces `numbers` by those of a line, which spaces, commas and semicolons separate; what follows '#' or
/// "//" is a comment. Returns false if something else is in the line; `numbers` then holds what came before.
inline bool numbers_of(std::string_view line, std::vector<double>& numbers) {
  constexpr std::string_view kSeparators = " \t\r,;";
  numbers.clear();
  for (;;) {
    const std::size_t first = line.find_first_not_of(kSeparators);
    if (first == std::string_view::npos) return true;
    line.remove_prefix(first);
    if (line[0] == '#' || line.starts_with("//")) return true;
    if (line[0] == '+') line.remove_prefix(1);
    double number = 0;
    const auto [end, fault] = std::from_chars(line.data(), line.data() + line.size(), number);
    const auto length = static_cast<std::size_t>(end - line.data());
    if (fault != std::errc() ||
        (length < line.size() && kSeparators.find(line[length]) == std::string_view::npos &&
         line[length] != '#'))
      return false;
    numbers.push_back(number);
    line.remove_prefix(length);
  }
}

}  // namespace sdm::io
