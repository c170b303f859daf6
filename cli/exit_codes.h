// What the exit code of the command means.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

enum ExitCode : int { kSuccess = 0, kFailure = 1, kInvalidUsage = 2, kToleranceExceeded = 3 };

struct ExitMeaning {
  ExitCode code;
  std::string_view meaning;
};
inline constexpr ExitMeaning kExitMeanings[] = {{kSuccess, "success"},
                                                {kFailure, "failure"},
                                                {kInvalidUsage, "invalid usage"},
                                                {kToleranceExceeded, "tolerance exceeded"}};

/// A sentence of the help of commands with a tolerance.
[[nodiscard]] inline std::string exit_codes() {
  std::string text = "Exit codes";
  for (const auto& [code, meaning] : kExitMeanings)
    text += fmt::format("{} {} {}", code == kSuccess ? ":" : ",", static_cast<int>(code), meaning);
  return text + ".";
}
