// Recognises STEP and IGES.
#include "io/mesh/formats.h"

namespace sdm::io {
namespace {

constexpr std::size_t kIgesLine = 80, kLetter = 72;  // characters; the column of the section's letter

}  // namespace

bool is_step(std::string_view bytes) {
  return bytes.substr(0, bytes.find_first_of(" ;\r\n")) == "ISO-10303-21";
}

bool is_iges(std::string_view bytes) {
  if (bytes.size() <= kIgesLine || bytes[kLetter] != 'S') return false;
  const std::string_view line = bytes.substr(0, kIgesLine), number = line.substr(kLetter + 1);
  return line.find_first_of("\r\n") == std::string_view::npos &&
         number.find_first_not_of(" 0") == number.size() - 1 && number.back() == '1' &&
         (bytes[kIgesLine] == '\r' || bytes[kIgesLine] == '\n');
}

}  // namespace sdm::io
