#include "help_text.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>

namespace {

// Characters, not bytes: bytes that continue one in UTF-8 do not count.
std::size_t length(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

void append_wrapped(std::string_view line, std::size_t width, std::size_t indent, std::string& result) {
  if (line.starts_with(' ')) {
    result += line;
    return;
  }
  std::size_t column = indent;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    const std::string_view word = line.substr(0, end);
    if (column > indent && column + 1 + length(word) > width) {
      result += '\n' + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      result += ' ';
      ++column;
    }
    result += word;
    column += length(word);
    line.remove_prefix(std::min(end + 1, line.size()));
  }
}

class HelpFormatter : public CLI::Formatter {
 public:
  explicit HelpFormatter(std::size_t width) : width_(width) {}

  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    return entry(make_option_name(option, is_positional) + make_option_opts(option),
                 make_option_desc(option));
  }
  std::string make_subcommand(const CLI::App* command) const override {
    return entry(command->get_display_name(true), command->get_description());
  }
  std::string make_description(const CLI::App* app) const override {
    return wrapped(CLI::Formatter::make_description(app), width_);
  }
  std::string make_footer(const CLI::App* app) const override {
    return wrapped(CLI::Formatter::make_footer(app), width_);
  }

 private:
  // A name, and the description beside it or, if the name is long, below.
  [[nodiscard]] std::string entry(const std::string& name, const std::string& description) const {
    const std::size_t column = std::min<std::size_t>(get_column_width(), width_ / 3);
    const std::size_t first = name.find_first_not_of(' ');
    std::string text = "  " + wrapped(std::string_view(name).substr(first), width_ - 2, 4);
    if (length(text) + 1 > column)
      text += '\n' + std::string(column, ' ');
    else
      text.append(column - length(text), ' ');
    return text + wrapped(description, width_, column) + '\n';
  }

  std::size_t width_;
};

}  // namespace

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  std::string result;
  while (true) {
    const std::size_t end = text.find('\n');
    append_wrapped(text.substr(0, end), width, indent, result);
    if (end == std::string_view::npos) return result;
    text.remove_prefix(end + 1);
    result += '\n';
    if (!text.empty()) result.append(indent, ' ');
  }
}

std::size_t help_width() {
  constexpr std::size_t kUsual = 80, kLeast = 40, kMost = 120;
  std::size_t width = 0;
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) width = size.ws_col;
  if (const char* columns = std::getenv("COLUMNS"); width == 0 && columns != nullptr)
    std::from_chars(columns, columns + std::string_view(columns).size(), width);
  return width == 0 ? kUsual : std::clamp(width, kLeast, kMost);
}

std::shared_ptr<CLI::FormatterBase> help_formatter(std::size_t width) {
  return std::make_shared<HelpFormatter>(width);
}
