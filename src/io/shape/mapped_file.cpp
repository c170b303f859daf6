#include "io/shape/mapped_file.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <cerrno>
// IWYU pragma: begin_keep: of systems without mmap()
#include <fstream>
#include <new>
// IWYU pragma: end_keep
#include <system_error>

#include "io/file/file_bytes.h"

#if __has_include(<sys/mman.h>)
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace sdm::io {
namespace {

[[noreturn]] void fail(const char* what) {
  throw Error(fmt::format("{}: {}", what, std::generic_category().message(errno)));
}

#if __has_include(<sys/mman.h>)

struct OpenFile {
  explicit OpenFile(const std::filesystem::path& file)
      : descriptor(open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor < 0) fail("cannot be opened");
  }
  ~OpenFile() { close(descriptor); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int descriptor;
};

MappedFile map(const std::filesystem::path& file) {
  const OpenFile from(file);
  struct stat status {};
  if (fstat(from.descriptor, &status) != 0) fail("cannot be read");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) throw Error("the file is empty");
  // Private: pages are those of the file until they are changed.
  void* const data = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE, from.descriptor, 0);
  if (data == MAP_FAILED) fail("cannot be mapped into memory");
  return {{static_cast<std::byte*>(data), size},
          std::shared_ptr<const void>(data, [size](void* mapped) { munmap(mapped, size); })};
}

#else

MappedFile map(const std::filesystem::path& file) {
  constexpr std::align_val_t kAlignment{64};
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail("cannot be opened");
  const auto size = static_cast<std::size_t>(std::filesystem::file_size(file));
  if (size == 0) throw Error("the file is empty");
  void* const data = ::operator new(size, kAlignment);
  std::shared_ptr<const void> owner(data, [](void* read) { ::operator delete(read, kAlignment); });
  if (!stream.read(static_cast<char*>(data), static_cast<std::streamsize>(size))) fail("cannot be read");
  return {{static_cast<std::byte*>(data), size}, std::move(owner)};
}

#endif

}  // namespace

MappedFile map_file(const std::filesystem::path& file, std::string_view kind) {
  require_regular_file(file, kind);
  return map(file);
}

}  // namespace sdm::io
