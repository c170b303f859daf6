// Files that appear under their final name only when complete.
#pragma once

#include <filesystem>
#include <fstream>

namespace sdm::io {

/// Writes to a temporary file next to `file`; commit() renames it, otherwise it is removed.
class AtomicFile {
 public:
  /// Throws sdm::Error if the folder cannot be written to, or if `file` exists and is not a regular file.
  /// All errors name `file`, never the temporary file.
  explicit AtomicFile(std::filesystem::path file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  [[nodiscard]] std::ostream& stream() { return stream_; }
  /// The temporary file, for what is written before to be read or changed.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// Throws sdm::Error if a write has failed, for example because the disk is full.
  void check() const;
  /// Throws as check() does.
  void commit();

 private:
  std::filesystem::path file_, temporary_;
  std::ofstream stream_;
  bool committed_ = false;
};

}  // namespace sdm::io
