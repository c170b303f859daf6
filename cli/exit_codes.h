// What the exit code of the command means.
#pragma once

#include <fmt/format.h>
#include <sdm/tolerance.h>

#include <string>
#include <string_view>

enum ExitCode : int {
  kSuccess = 0,
  kFailure = 1,
  kInvalidUsage = 2,
  kToleranceExceeded = 3,
  kNotDecided = 4,
  kDoubtful = 5
};

struct ExitMeaning {
  ExitCode code;
  std::string_view meaning;
};
inline constexpr ExitMeaning kExitMeanings[] = {{kSuccess, "success"},
                                                {kFailure, "failure"},
                                                {kInvalidUsage, "invalid usage"},
                                                {kToleranceExceeded, "tolerance exceeded (FAIL)"},
                                                {kNotDecided, "not decided"},
                                                {kDoubtful, "doubtful"}};

/// A sentence of the help of commands with a tolerance.
[[nodiscard]] inline std::string exit_codes() {
  std::string text = "Exit codes";
  for (const auto& [code, meaning] : kExitMeanings)
    text += fmt::format("{} {} {}", code == kSuccess ? ":" : ",", static_cast<int>(code), meaning);
  return text + ".";
}

/// The verdict of several that the exit code states.
[[nodiscard]] constexpr sdm::Verdict worse(sdm::Verdict a, sdm::Verdict b) {
  using enum sdm::Verdict;
  for (const sdm::Verdict verdict : {fail, not_decided, doubtful})
    if (a == verdict || b == verdict) return verdict;
  return pass;
}

[[nodiscard]] constexpr ExitCode exit_code(sdm::Verdict verdict) {
  switch (verdict) {
    case sdm::Verdict::pass:
      break;
    case sdm::Verdict::fail:
      return kToleranceExceeded;
    case sdm::Verdict::not_decided:
      return kNotDecided;
    case sdm::Verdict::doubtful:
      return kDoubtful;
  }
  return kSuccess;
}
