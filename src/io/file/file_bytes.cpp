#include "io/file/file_bytes.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <cerrno>
#include <fstream>
#include <span>
#include <system_error>
#include <vector>

#include "core/checksum.h"
#include "core/memory.h"
#include "io/file/error_prefix.h"
#include "io/file/input_files.h"

namespace sdm::io {
namespace {

// The mesh and the data it is built from take, in every format, at most five times the memory of the file.
constexpr std::size_t kMemoryPerByte = 5;

}  // namespace

void require_regular_file(const std::filesystem::path& file, std::string_view kind) {
  std::error_code error;
  const auto type = std::filesystem::status(file, error).type();
  if (type == std::filesystem::file_type::not_found) throw Error("there is no such file");
  if (type == std::filesystem::file_type::directory)
    throw Error(fmt::format("this is a folder, not a {} file", kind));
  if (error) throw Error(fmt::format("cannot be read: {}", error.message()));
  if (type != std::filesystem::file_type::regular) throw Error("this is not a regular file");
  note_input(file);
}

FileBytes read_bytes(const std::filesystem::path& file) {
  require_regular_file(file, "mesh");
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(fmt::format("cannot be opened: {}", std::generic_category().message(errno)));

  FileBytes bytes;
  bytes.size = std::filesystem::file_size(file);
  if (bytes.size == 0) throw Error("the file is empty");
  require_memory(bytes.size > SIZE_MAX / kMemoryPerByte ? SIZE_MAX : bytes.size * kMemoryPerByte,
                 "reading it");
  bytes.data = std::make_unique_for_overwrite<char[]>(bytes.size);
  if (!stream.read(bytes.data.get(), static_cast<std::streamsize>(bytes.size)))
    throw Error(fmt::format("cannot be read: {}", stream.eof() ? "it became shorter while it was being read"
                                                               : std::generic_category().message(errno)));
  return bytes;
}

}  // namespace sdm::io

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
