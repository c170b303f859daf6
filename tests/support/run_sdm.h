// Runs the command sdm, or another program, in a process of its own.
#pragma once

#include <csignal>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sdm::test {

struct Outcome {
  int code = -1;  ///< exit code, or 128 + the signal that ended it
  std::string out, err;
  double cpu_after_signal =
      0;  ///< seconds of processor time, of all threads, from the first signal to the end
};

struct Conditions {
  std::optional<std::uint64_t> file_size{};  ///< no file can grow beyond it: a full disk
  std::optional<std::uint64_t> memory{};     ///< address space
  std::optional<std::uint64_t> stack{};      ///< of the main thread
  std::vector<std::string> environment{};    ///< NAME=value, besides that of this program
  bool terminal = false;                     ///< stderr is a terminal
  std::uint16_t columns = 0;                 ///< stdout is a terminal of that width, unless 0
  int interrupt_after_ms = 0;                ///< send `signal` then, unless 0
  int interrupt_after_lines = 0;             ///< send `signal` once stdout has that many, unless 0
  int signal = SIGINT;
  int kill_after_ms = 0;  ///< send SIGKILL then, unless 0
};

[[nodiscard]] Outcome run_program(const char* program, const std::vector<std::string>& arguments,
                                  const Conditions& options = {});
/// The command sdm.
[[nodiscard]] Outcome run_sdm(const std::vector<std::string>& arguments, const Conditions& options = {});

}  // namespace sdm::test
