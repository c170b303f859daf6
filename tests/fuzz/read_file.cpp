// Fuzzer of the reader of one format, SDM_FUZZ_EXTENSION; see tests/long.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "io_read/try_read.h"

namespace {

// A folder of this process, in memory if TMPDIR is; removed at the end of the process.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("sdm-fuzz-" + std::to_string(getpid()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  static const std::filesystem::path file = folder.path / ("input." SDM_FUZZ_EXTENSION);
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  sdm::test::try_read(file);
  return 0;
}
