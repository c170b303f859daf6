// Files whose names differ in a number.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sdm::io {

/// Names of files that are alike but for a number, which goes up in equal steps; some may be missing.
class NumberedFiles {
 public:
  /// Those in the folder that match `pattern`, its last part: one %d or %04d, as printf prints it, or * for
  /// digits. Throws sdm::Error for another pattern, where there is no such file or more are missing than
  /// there are, and for two files of one number.
  [[nodiscard]] static NumberedFiles like(const std::filesystem::path& pattern);
  /// Those in the folder with the extension of a mesh file, whose names end in a number. Throws sdm::Error as
  /// above, and where they are not alike.
  [[nodiscard]] static NumberedFiles in(const std::filesystem::path& folder);

  /// Missing ones included.
  [[nodiscard]] std::size_t count() const;
  /// Empty where it is missing.
  [[nodiscard]] std::filesystem::path file(std::size_t index) const;
  [[nodiscard]] std::uint64_t number(std::size_t index) const { return files_[0].number + index * step_; }

 private:
  struct File {
    std::uint64_t number;
    std::filesystem::path path;
  };
  explicit NumberedFiles(std::vector<File> files);

  std::vector<File> files_;  // by number
  std::uint64_t step_ = 1;
};

}  // namespace sdm::io
