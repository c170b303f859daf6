#include "terminal_text.h"

#include <iostream>
#include <new>

#include "src/core/printable.h"

namespace {

// Passes on whole lines, so that no character is cut; the last one when it is flushed.
class LineBuffer : public std::streambuf {
 public:
  explicit LineBuffer(std::streambuf& target) : target_(target) {}

 protected:
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    line_.append(text, static_cast<std::size_t>(count));
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
    const std::string text = printable_lines(std::string_view(line_).substr(0, count));
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
