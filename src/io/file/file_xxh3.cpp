#include "io/file/file_xxh3.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <cerrno>
#include <fstream>
#include <span>
#include <system_error>
#include <vector>

#include "io/file/error_prefix.h"
#include "io/file/file_bytes.h"

namespace sdm {

void io::add_file(core::Checksum& checksum, const std::filesystem::path& file) {
  const auto failed = [&](const char* what) {
    return Error(
        fmt::format("{}: cannot be {}: {}", file.string(), what, std::generic_category().message(errno)));
  };
  with_error_prefix(file.string(), [&] { require_regular_file(file, "data"); });
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw failed("opened");
  std::vector<char> part(std::size_t{1} << 18);  // stays in the cache
  while (stream) {
    stream.read(part.data(), static_cast<std::streamsize>(part.size()));
    checksum.add(std::span<const char>(part.data(), static_cast<std::size_t>(stream.gcount())));
  }
  if (stream.bad()) throw failed("read");
}

std::string file_xxh3(const std::filesystem::path& file) {
  core::Checksum checksum;
  io::add_file(checksum, file);
  return core::hex_text(checksum.value());
}

}  // namespace sdm
