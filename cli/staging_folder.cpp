#include "staging_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sdm/error.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <optional>
#include <random>
#include <system_error>
#include <thread>
#include <vector>

#include "interrupts.h"
#include "read_files.h"

namespace fs = std::filesystem;

namespace {

// A staging folder: its name begins with kPrefix, it contains the empty file kMarker, created first, and the
// files of the run below kStagedFiles. Without the marker, a folder of that name is sdm's only while it is
// empty, and has the mode with which it is created: a process can be killed between the two.
constexpr const char* kPrefix = ".sdm-part-";
constexpr const char* kMarker = ".sdm-staging";
constexpr mode_t kMode = S_ISVTX | S_IRWXU;

bool is_staging(const fs::path& folder) {
  struct stat info {};
  if (!folder.filename().string().starts_with(kPrefix) || lstat(folder.c_str(), &info) != 0 ||
      !S_ISDIR(info.st_mode))
    return false;
  constexpr mode_t kAllModes = 07777;
  const bool created = (info.st_mode & kAllModes) == kMode;
  return lstat((folder / kMarker).c_str(), &info) == 0 ? S_ISREG(info.st_mode) : created;
}

}  // namespace

void cannot_write(const fs::path& path, const std::string& fault) {
  throw sdm::Error(
      fmt::format("cannot write to {}: {}; choose another folder with -o", path.string(), fault));
}

void create_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) cannot_write(path, error.message());
}

FolderLock::FolderLock(const fs::path& folder)
    : file_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)),
      error_(file_ >= 0 && flock(file_, LOCK_EX | LOCK_NB) == 0 ? 0 : errno) {}

FolderLock::~FolderLock() {
  if (file_ >= 0) close(file_);
}

bool FolderLock::busy() const {
  return error_ == EWOULDBLOCK || error_ == EINTR;
}

std::unique_ptr<const FolderLock> turn_to_move(const fs::path& folder) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kStep = std::chrono::milliseconds(5), kAfterInterrupt = std::chrono::milliseconds(300);
  constexpr auto kMost = std::chrono::seconds(60);  // moving takes milliseconds: the other one is suspended
  const auto start = Clock::now();
  for (std::optional<Clock::time_point> interrupted;; std::this_thread::sleep_for(kStep)) {
    auto lock = std::make_unique<const FolderLock>(folder);
    if (!lock->busy()) return lock;
    if (!interrupted && Interrupts::received()) interrupted = Clock::now();
    if (interrupted && Clock::now() - *interrupted > kAfterInterrupt) throw sdm::Cancelled();
    if (Clock::now() - start > kMost)
      cannot_write(folder, fmt::format("another run has been moving files there for {} s", kMost.count()));
  }
}

void remove_staging(const fs::path& staging) {
  std::error_code ignored;
  if (fs::remove_all(staging / kStagedFiles, ignored); fs::exists(staging / kStagedFiles, ignored)) return;
  fs::remove(staging / kMarker, ignored);
  fs::remove(staging, ignored);
}

void remove_abandoned(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (is_staging(entry.path()) && !is_among_arguments(entry.path())) found.push_back(entry.path());
  for (const fs::path& staging : found)
    if (const FolderLock lock(staging); lock.held()) remove_staging(staging);
}

std::pair<fs::path, std::shared_ptr<const void>> make_staging(const fs::path& folder) {
  // Where others do the same: a run that failed removes the folder that it made, if nothing is in it yet; and
  // a staging folder may be taken for abandoned until it is locked.
  constexpr int kAttempts = 100;
  std::random_device random;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    create_folder(folder);
    fs::path path = folder / fmt::format("{}{:08x}", kPrefix, random());
    std::string marker = (path / kMarker).string();
    if (mkdir(path.c_str(), kMode) != 0) {
      if (errno == ENOENT || errno == EEXIST) continue;
      cannot_write(folder, std::generic_category().message(errno));
    }
    try {
      auto lock = std::make_shared<const FolderLock>(path);
      const int file =
          lock->busy() ? -1 : open(marker.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
      const int error = errno;
      if (file >= 0) {
        close(file);
        return {std::move(path), std::move(lock)};
      }
      if (!lock->busy() && error != ENOENT) cannot_write(folder, std::generic_category().message(error));
    } catch (...) {  // for lack of memory or space
      unlink(marker.c_str());
      rmdir(path.c_str());
      throw;
    }
  }
  cannot_write(folder, "other processes keep removing files there");
}
