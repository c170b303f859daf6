// Matches of POSIX regular expressions: GCC 12 warns in the templates of std::regex where sanitizers are on.
#pragma once

#include <regex.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace sdm::test {

struct Match {
  std::size_t begin, end;
  std::vector<std::string> groups;
};

/// The matches of an extended regular expression, one after the other. "." is any character but "\n".
inline std::vector<Match> matches(const std::string& text, const char* pattern) {
  constexpr std::size_t kGroups = 4;  // with the whole match
  regex_t compiled{};
  if (regcomp(&compiled, pattern, REG_EXTENDED | REG_NEWLINE) != 0) throw std::invalid_argument(pattern);
  std::vector<Match> result;
  regmatch_t found[kGroups]{};
  for (std::size_t at = 0;;) {
    const int flags = at > 0 && text[at - 1] != '\n' ? REG_NOTBOL : 0;
    if (regexec(&compiled, text.c_str() + at, kGroups, found, flags) != 0) break;
    Match match{.begin = at + static_cast<std::size_t>(found[0].rm_so),
                .end = at + static_cast<std::size_t>(found[0].rm_eo),
                .groups = {}};
    for (std::size_t k = 1; k < kGroups; ++k)
      if (found[k].rm_so >= 0)
        match.groups.push_back(text.substr(at + static_cast<std::size_t>(found[k].rm_so),
                                           static_cast<std::size_t>(found[k].rm_eo - found[k].rm_so)));
    if (match.end == match.begin) throw std::invalid_argument(pattern);  // it matches without end
    at = match.end;
    result.push_back(std::move(match));
  }
  regfree(&compiled);
  return result;
}

}  // namespace sdm::test
