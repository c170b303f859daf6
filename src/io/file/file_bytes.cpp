#include "io/file/file_bytes.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "core/memory.h"
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
