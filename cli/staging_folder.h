// Staging folders, in which the files of a run are until they are moved into place together, and locks on
// folders.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

/// Throws sdm::Error.
[[noreturn]] void cannot_write(const std::filesystem::path& path, const std::string& fault);

void create_folder(const std::filesystem::path& path);

/// A lock on a folder, which the system releases when its process ends, however it ends. Processes on
/// other machines and in other containers see it too, which is not true of the number of the process.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  [[nodiscard]] bool held() const { return error_ == 0; }
  /// Another process holds it.
  [[nodiscard]] bool busy() const;

 private:
  int file_, error_;
};

/// Files are moved by one run at a time: each takes a lock on the output folder first, which leaves no file
/// behind and ends with its process. Where the file system has no locks (some network file systems), or the
/// folder cannot be read, runs do not wait for each other.
[[nodiscard]] std::unique_ptr<const FolderLock> turn_to_move(const std::filesystem::path& folder);

/// The folder of the files of the run, below a staging folder.
inline constexpr const char* kStagedFiles = "files";

/// Creates a staging folder with a name of its own, and locks it. The lock is held until it is destroyed.
[[nodiscard]] std::pair<std::filesystem::path, std::shared_ptr<const void>> make_staging(
    const std::filesystem::path& folder);

/// Only what sdm has put there. The marker goes last, as what has none remains.
void remove_staging(const std::filesystem::path& staging);

/// Removes the staging folders of processes that were killed. Where the file system has no locks they remain.
void remove_abandoned(const std::filesystem::path& folder);
