// Words in upper or lower case.
#pragma once

#include <algorithm>
#include <string_view>

namespace sdm::io {

/// Returns whether a word is this one in lower case, but for the case of ASCII letters.
[[nodiscard]] inline bool same_word(std::string_view word, std::string_view lower_case) {
  return std::equal(word.begin(), word.end(), lower_case.begin(), lower_case.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

}  // namespace sdm::io
