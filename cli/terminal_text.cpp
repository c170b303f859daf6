#include "terminal_text.h"

#include <sdm/tolerance.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iostream>
#include <new>
#include <utility>

#include "help_text.h"
#include "patience.h"
#include "src/core/printable.h"

namespace {

// Where the text of a line begins: after a label, such as "  error     ", or after the indentation.
std::size_t text_column(std::string_view line) {
  const std::size_t first = line.find_first_not_of(' ');
  if (first == std::string_view::npos || first == 0) return 2;
  if (first > 2) return first;
  const std::size_t gap = line.find("  ", first);
  const std::size_t text = gap == std::string_view::npos ? gap : line.find_first_not_of(' ', gap);
  // A label of full width, such as "  tolerance ", has one blank after it.
  return text == std::string_view::npos || text > 16 ? line.find(' ', first) + 1 : text;
}

std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

// Bold, and green, red or yellow, where the text of a line is a verdict.
std::string colored(std::string line) {
  constexpr std::array<std::pair<sdm::Verdict, const char*>, 4> kColors{{{sdm::Verdict::pass, "32"},
                                                                         {sdm::Verdict::fail, "31"},
                                                                         {sdm::Verdict::not_decided, "33"},
                                                                         {sdm::Verdict::doubtful, "33"}}};
  const std::size_t begin = line.starts_with("  ") ? std::min(text_column(line), line.size()) : 0;
  for (const auto& [verdict, color] : kColors) {
    const std::string word = sdm::name_of(verdict);
    if (!std::string_view(line).substr(begin).starts_with(word)) continue;
    line.insert(begin + word.size(), "\x1b[0m");
    line.insert(begin, std::string("\x1b[1;") + color + "m");
    break;
  }
  return line;
}

std::string broken(std::string_view line, std::size_t width) {
  const std::size_t indent = text_column(line);
  std::string result;
  std::size_t used = 0;
  while (true) {
    std::size_t end = line.find(' ', line.find_first_not_of(' ', 0));
    const std::string_view word = line.substr(0, end);
    const std::size_t size = characters(word);
    if (used > indent && used + size > width) {
      result += '\n' + std::string(indent, ' ');
      const std::string_view bare = word.substr(std::min(word.find_first_not_of(' '), word.size()));
      result += bare;
      used = indent + characters(bare);
    } else {
      result += word;
      used += size;
    }
    if (end == std::string_view::npos) return result;
    line.remove_prefix(end);
  }
}

bool has_colors() {
  const char *off = std::getenv("NO_COLOR"), *kind = std::getenv("TERM");
  return (off == nullptr || *off == '\0') && kind != nullptr && std::string_view(kind) != "dumb";
}

// Passes on whole lines, so that no character is cut; the last one when it is flushed.
class LineBuffer : public std::streambuf {
 public:
  explicit LineBuffer(std::streambuf& target) : target_(target) {}

  /// Prints printable lines as they are.
  void put(std::string_view text) {
    if (pass_on(line_.size())) target_.sputn(text.data(), static_cast<std::streamsize>(text.size()));
  }

 protected:
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    patiently([&] { line_.append(text, static_cast<std::size_t>(count)); });
    const std::size_t end = line_.rfind('\n');
    return end == std::string::npos || pass_on(end + 1) ? count : 0;
  }
  int overflow(int c) override {
    if (c == traits_type::eof()) return traits_type::not_eof(c);
    const char character = traits_type::to_char_type(c);
    return xsputn(&character, 1) == 1 ? c : traits_type::eof();
  }
  int sync() override { return pass_on(line_.size()) ? target_.pubsync() : -1; }

 private:
  bool pass_on(std::size_t count) {
    const std::string text =
        patiently([&] { return printable_lines(std::string_view(line_).substr(0, count)); });
    line_.erase(0, count);
    const auto size = static_cast<std::streamsize>(text.size());
    return target_.sputn(text.data(), size) == size;
  }

  std::streambuf& target_;
  std::string line_;
};

}  // namespace

std::string printable_lines(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    result += sdm::printable(text.substr(0, end));
    if (end == std::string_view::npos) break;
    result += '\n';
    text.remove_prefix(end + 1);
  }
  return result;
}

void print_for_people(std::string_view text) {
  auto* const lines = dynamic_cast<LineBuffer*>(std::cout.rdbuf());
  if (lines == nullptr || isatty(STDOUT_FILENO) == 0) {
    std::cout << text;
    return;
  }
  const std::size_t width = help_width();
  const bool colors = has_colors();
  std::string result;
  for (std::string printable = printable_lines(text); !printable.empty();) {
    const std::size_t end = std::min(printable.find('\n'), printable.size());
    const std::string line = broken(std::string_view(printable).substr(0, end), width);
    result += (colors ? colored(line) : line) + "\n";
    printable.erase(0, end + 1);
  }
  lines->put(result);
}

PrintableOutput::PrintableOutput()
    : original_(std::cout.rdbuf()), lines_(std::make_unique<LineBuffer>(*original_)) {
  std::cout.rdbuf(lines_.get());
}

PrintableOutput::~PrintableOutput() {
  try {
    lines_->pubsync();
  } catch (const std::bad_alloc&) {
    // The command fails already: it flushes what it prints when it succeeds.
  }
  std::cout.rdbuf(original_);
}
