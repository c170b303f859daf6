// Files whose names differ only in a number.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace sdm::io {

/// Files whose names differ only in a number, which increases in equal steps. Some may be missing.
class NumberedFiles {
 public:
  /// Finds the files in a folder whose names match the last component of `pattern`, which contains either one
  /// %d or %04d, as in printf, or one * for any digits. Throws sdm::Error if the pattern is different, if no
  /// file matches, if more files are missing than exist, or if two have the same number.
  [[nodiscard]] static NumberedFiles like(const std::filesystem::path& pattern);
  /// Finds the files in a folder that have the extension of a mesh file and a name that ends in a number.
  /// Throws sdm::Error as above, and if the names differ in more than the number.
  [[nodiscard]] static NumberedFiles in(const std::filesystem::path& folder);

  /// Returns the number of files, including missing ones.
  [[nodiscard]] std::size_t count() const;
  /// Returns the path of a file; empty if it is missing.
  [[nodiscard]] std::filesystem::path file(std::size_t index) const;
  [[nodiscard]] std::uint64_t number(std::size_t index) const { return files_[0].number + index * step_; }

 private:
  struct File {
    std::uint64_t number;
    std::filesystem::path path;
  };
  explicit NumberedFiles(std::vector<File> files);

  std::vector<File> files_;  // in order of their numbers
  std::uint64_t step_ = 1;
};

}  // namespace sdm::io
