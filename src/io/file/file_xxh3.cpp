#include "io/file/file_xxh3.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/io.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

namespace sdm {

void io::add_file(core::Checksum& checksum, const std::filesystem::path& file) {
  const auto failed = [&](const char* what) {
    return Error(fmt::format("{}: cannot be {}: {}", file.string(), what, std::strerror(errno)));
  };
  const auto close = [](std::FILE* stream) { std::fclose(stream); };
  const std::unique_ptr<std::FILE, decltype(close)> stream(std::fopen(file.c_str(), "rb"), close);
  if (!stream) throw failed("opened");
  std::vector<char> part(std::size_t{1} << 18);  // stays in the cache
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), stream.get()))
    checksum.add(std::span<const char>(part.data(), count));
  if (std::ferror(stream.get())) throw failed("read");
}

std::string file_xxh3(const std::filesystem::path& file) {
  core::Checksum checksum;
  io::add_file(checksum, file);
  return core::hex_text(checksum.value());
}

}  // namespace sdm
