#include "io/write/atomic_file.h"

#include <sdm/error.h>

#include <atomic>
#include <cerrno>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>

#include "core/platform.h"

namespace sdm {
namespace {

std::string reason(int error) {
  return error != 0 ? std::generic_category().message(error) : "write error";
}

// Distinct for every file that this machine's processes write at the same time.
std::filesystem::path temporary_beside(const std::filesystem::path& file) {
  static std::atomic<unsigned> count{0};
  std::ostringstream name;
  name << '.' << file.filename().string() << '.' << process_number() << '.' << count++ << ".part";
  return file.parent_path() / name.str();
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path file)
    : file_(std::move(file)), temporary_(temporary_beside(file_)) {
  std::error_code ignored;
  if (exists(file_, ignored) && !is_regular_file(file_, ignored))
    throw Error("cannot write " + file_.string() + ": that name exists and is not a file; choose another");
  errno = 0;
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_)
    throw Error("cannot write " + file_.string() + ": " + reason(errno) +
                "; choose a folder that can be written to");
}

AtomicFile::~AtomicFile() {
  if (committed_) return;
  stream_.close();
  std::error_code ignored;
  remove(temporary_, ignored);
}

void AtomicFile::check() const {
  if (!stream_)
    throw Error("cannot write " + file_.string() + ": " + reason(errno) +
                "; free space or choose another folder");
}

void AtomicFile::commit() {
  check();
  errno = 0;
  stream_.close();
  check();
  std::error_code error;
  rename(temporary_, file_, error);
  if (error)
    throw Error("cannot write " + file_.string() + ": " + error.message() + "; choose another folder");
  committed_ = true;
}

}  // namespace sdm
