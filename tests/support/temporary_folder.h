// A folder for the files of a test.
#pragma once

#include <filesystem>
#include <random>
#include <string>
#include <system_error>

namespace sdm::test {

/// An empty folder of this process's own, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() : TemporaryFolder(std::filesystem::temp_directory_path()) {}
  explicit TemporaryFolder(const std::filesystem::path& parent) {
    do path_ = parent / ("sdm-test-" + random_letters());
    while (!std::filesystem::create_directory(path_));
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] bool empty() const { return std::filesystem::is_empty(path_); }

 private:
  /// Always six, so that lines with a path of the folder are of one length.
  static std::string random_letters() {
    std::random_device random;
    std::string letters(6, ' ');
    for (char& letter : letters) letter = static_cast<char>('a' + random() % 26);
    return letters;
  }

  std::filesystem::path path_;
};

}  // namespace sdm::test
