// What the command prints: no control characters of files or file names, only line ends.
#pragma once

#include <memory>
#include <streambuf>
#include <string>
#include <string_view>

/// sdm::printable() of each line.
[[nodiscard]] std::string printable_lines(std::string_view text);

/// Prints lines of text for people. On a terminal, a line that is longer than it is wide is broken at blanks,
/// below where its text begins, and verdicts are coloured, unless the environment variable NO_COLOR is set
/// (https://no-color.org); elsewhere, the text is as it is.
void print_for_people(std::string_view text);

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
