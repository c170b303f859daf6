#include "open_text.h"

#include <sdm/error.h>

#include <string>

namespace fs = std::filesystem;

std::ifstream open_text(const fs::path& file) {
  const auto fail = [&](const char* fault) { throw sdm::Error(file.string() + ": " + fault); };
  std::error_code error;
  const fs::file_type type = fs::status(file, error).type();
  if (type == fs::file_type::not_found) fail("there is no such file");
  if (type == fs::file_type::directory) fail("this is a folder, not a text file");
  if (type != fs::file_type::regular) fail("this is not a regular file");
  std::ifstream stream(file);
  if (!stream) fail("cannot be opened");
  return stream;
}
