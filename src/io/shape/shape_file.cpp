#include <sdm/map_files.h>

#include <ios>
#include <utility>

#include "io/file/atomic_file.h"
#include "io/file/error_prefix.h"
#include "io/shape/mapped_file.h"

namespace sdm {

void write_shape(const std::filesystem::path& file, const Shape& shape) {
  io::AtomicFile to(file);
  shape.store([&](std::span<const std::byte> bytes) {
    to.stream().write(reinterpret_cast<const char*>(bytes.data()),
                      static_cast<std::streamsize>(bytes.size()));
    to.check();
  });
  to.commit();
}

Shape read_shape(const std::filesystem::path& file, const ReadShapeOptions& options) {
  return io::with_error_prefix(file.string(), [&] {
    io::MappedFile mapped = io::map_file(file, "shape");
    return Shape(StoredShape{mapped.bytes, std::move(mapped.owner), options.trusted});
  });
}

}  // namespace sdm
