// What the exit code of the command means.
#pragma once

enum ExitCode : int { kSuccess = 0, kFailure = 1, kInvalidUsage = 2, kToleranceExceeded = 3 };

/// A sentence of the help of commands with a tolerance.
inline constexpr const char* kExitCodes =
    "Exit codes: 0 success, 1 failure, 2 invalid usage, 3 tolerance exceeded.";
