#include "atlas_cache.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <vector>

#include "output_folder.h"
#include "src/io/file/input_files.h"

namespace fs = std::filesystem;

namespace {

// Reads no more than the atlas of this mesh can have, which shows that a larger file is not one.
std::vector<std::uint8_t> read_bytes(const fs::path& file, const sdm::Mesh& mesh,
                                     std::uint64_t resolution) try {
  if (!fs::is_regular_file(file)) throw sdm::Error("it is not a stored atlas");
  const std::uint64_t most = 1024 + 128 * mesh.triangles.size() + 8 * resolution * resolution;
  std::vector<std::uint8_t> bytes(std::min<std::uint64_t>(fs::file_size(file), most));
  sdm::io::note_input(file);
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) throw sdm::Error("it cannot be read");
  return bytes;
} catch (const fs::filesystem_error& error) {
  throw sdm::Error(error.code().message());
}

}  // namespace

sdm::Surface cached_surface(const sdm::Mesh& mesh, const sdm::AtlasOptions& options, const fs::path& file) {
  if (file.empty()) return sdm::Surface(mesh, options);
  if (!fs::exists(file)) {
    sdm::Surface surface(mesh, options);
    const std::vector<std::uint8_t> bytes = surface.stored_atlas();
    write_whole(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return surface;
  }
  try {
    return sdm::Surface(mesh, options, read_bytes(file, mesh, options.resolution));
  } catch (const sdm::Error& error) {
    throw sdm::Error(
        fmt::format("{}: {}; name another file with --atlas-cache", file.string(), error.what()));
  }
}
