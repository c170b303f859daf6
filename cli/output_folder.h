// The output folder of a command, which receives all files or is left unchanged.
#pragma once

#include <filesystem>
#include <string>

/// Results are first written to a hidden folder inside; commit() moves them to their places. Without it
/// nothing remains: no file, and no folder that was not there before.
class OutputFolder {
 public:
  /// Throws sdm::Error when `folder` is a file, or cannot be created or written to.
  explicit OutputFolder(const std::filesystem::path& folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write what commit() moves to `folder`/`subfolder`.
  [[nodiscard]] std::filesystem::path staging(const std::filesystem::path& subfolder = {});
  /// A message about the staging folder, in terms of the folder of the results.
  [[nodiscard]] std::string publicly(std::string message) const;
  /// Replaces files of an earlier run. Throws sdm::Error when a result's place is taken by a folder.
  void commit();

 private:
  void remove_traces();

  std::filesystem::path folder_, staging_;
  std::filesystem::path existing_;  ///< the closest ancestor of folder_, or itself, that was there before
};

/// Throws sdm::Error where not all of the text could be written.
void write_text(const std::filesystem::path& file, const std::string& text);
