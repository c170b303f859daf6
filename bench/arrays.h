// Arrays in files without headers, for other programs.
#pragma once

#include <sdm/error.h>

#include <filesystem>
#include <fstream>
#include <span>

namespace sdm::bench {

/// Throws sdm::Error if the file cannot be written.
template <class T>
void write_array(const std::filesystem::path& file, std::span<const T> values) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size_bytes()));
  out.close();
  if (!out) throw Error("cannot write " + file.string());
}

}  // namespace sdm::bench
