#include "open_text.h"

#include <sdm/error.h>

#include "src/io/file/file_bytes.h"

std::ifstream open_text(const std::filesystem::path& file) try {
  sdm::io::require_regular_file(file, "text");
  std::ifstream stream(file);
  if (!stream) throw sdm::Error("cannot be opened");
  return stream;
} catch (const sdm::Error& error) {
  throw sdm::Error(file.string() + ": " + error.what());
}
