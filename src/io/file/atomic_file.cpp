#include "io/file/atomic_file.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <atomic>
#include <cerrno>
#include <random>
#include <string>
#include <system_error>
#include <utility>

#include "core/platform.h"

namespace sdm::io {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& fault, const char* remedy) {
  throw Error(fmt::format("cannot write {}: {}; {}", file.string(), fault, remedy));
}

std::string reason(int error) {
  return error != 0 ? std::generic_category().message(error) : "write error";
}

// By chance unique among the files that all processes write concurrently: processes of several containers or
// machines that share a folder can have the same number.
std::filesystem::path temporary_beside(const std::filesystem::path& file) {
  static std::atomic<unsigned> count{0};
  static const unsigned chance = std::random_device()();
  return file.parent_path() /
         fmt::format(".{}.{}-{:08x}.{}.part", file.filename().string(), process_number(), chance, count++);
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path file)
    : file_(std::move(file)), temporary_(temporary_beside(file_)) {
  std::error_code ignored;
  if (exists(file_, ignored) && !is_regular_file(file_, ignored))
    fail(file_, "that name exists and is not a file", "choose another");
  errno = 0;
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_) fail(file_, reason(errno), "choose a folder that can be written to");
}

AtomicFile::~AtomicFile() {
  if (committed_) return;
  stream_.close();
  std::error_code ignored;
  remove(temporary_, ignored);
}

void AtomicFile::check() const {
  if (!stream_) fail(file_, reason(errno), "free space or choose another folder");
}

void AtomicFile::commit() {
  check();
  errno = 0;
  stream_.close();
  check();
  std::error_code error;
  rename(temporary_, file_, error);
  if (error) fail(file_, error.message(), "choose another folder");
  committed_ = true;
}

}  // namespace sdm::io
