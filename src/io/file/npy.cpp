#include "io/file/npy.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/map_files.h>

#include <algorithm>
#include <array>
#include <new>

#include "core/memory.h"
#include "io/file/atomic_file.h"
#include "io/file/little_endian.h"

namespace sdm {

std::string io::npy_header(std::string_view type, std::span<const std::uint64_t> shape, NpyOrder order) {
  const char* quote = type.starts_with('[') ? "" : "'";
  std::string dictionary = fmt::format("{{'descr': {0}{1}{0}, 'fortran_order': {2}, 'shape': ({3}{4}), }}",
                                       quote, type, order == NpyOrder::first_fastest ? "True" : "False",
                                       fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
  std::string header = "\x93NUMPY";
  header += {'\1', '\0'};
  constexpr std::size_t kStep = 64, kLeast = 128;
  const std::size_t size = std::max(kLeast, (header.size() + 2 + dictionary.size() + kStep) / kStep * kStep);
  append_little_endian(header, static_cast<std::uint16_t>(size - header.size() - 2));
  dictionary.resize(size - header.size() - 1, ' ');
  return header + dictionary + '\n';
}

void write_npy(const std::filesystem::path& file, std::uint32_t resolution,
               std::span<const std::uint32_t> values) try {
  if (resolution == 0 || values.empty() || values.size() % resolution != 0)
    throw Error(fmt::format("cannot write {}: {} values are not whole rows of {} texels", file.string(),
                            values.size(), resolution));
  const std::uint64_t rows = values.size() / resolution;
  io::AtomicFile out(file);
  out.stream() << io::npy_header("<u4", std::array<std::uint64_t, 2>{rows, resolution});
  std::string bytes;
  bytes.reserve(values.size_bytes());
  for (const std::uint32_t value : values) io::append_little_endian(bytes, value);
  out.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
