// What the command prints: no control characters of files or file names, only line ends.
#pragma once

#include <memory>
#include <streambuf>
#include <string>
#include <string_view>

/// sdm::printable() of each line.
[[nodiscard]] std::string printable_lines(std::string_view text);

/// While it exists, all that is written to std::cout passes through printable_lines(). JSON keeps its
/// meaning, because both write escapes the same way.
class PrintableOutput {
 public:
  PrintableOutput();
  ~PrintableOutput();
  PrintableOutput(const PrintableOutput&) = delete;
  PrintableOutput& operator=(const PrintableOutput&) = delete;

 private:
  std::streambuf* original_;
  std::unique_ptr<std::streambuf> lines_;
};
