// Files that appear under their name whole, or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>

namespace sdm {

/// Writes to a temporary file next to `file`; commit() renames it, otherwise it is removed.
class AtomicFile {
 public:
  /// Throws sdm::Error when the folder cannot be written to, or `file` is there and no plain file.
  explicit AtomicFile(std::filesystem::path file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  [[nodiscard]] std::ostream& stream() { return stream_; }
  /// Throws sdm::Error when anything written so far was refused, as by a full disk.
  void check() const;
  /// Throws as check() does.
  void commit();

 private:
  std::filesystem::path file_, temporary_;
  std::ofstream stream_;
  bool committed_ = false;
};

}  // namespace sdm
