// The output folder of a command, which receives either all files or none.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

/// Files are first written to a hidden staging folder inside the output folder, and moved into place at the
/// end; those that show that results are complete, such as report.json, come last. After a failure no file
/// remains, and no folder that did not exist before. A process that is killed leaves its staging folder,
/// which the next run into the same folder removes; what else is there, whatever its name is, remains.
///
/// Of several runs into one folder, each moves its files while the others wait, so that the files are those
/// of the run that ended last. Where the file system has no locks, such runs must not end at the same time.
class OutputFolder {
 public:
  /// Returns files that earlier runs may have left, relative to the folder.
  using Earlier = std::function<std::vector<std::filesystem::path>()>;

  /// `earlier` is called when this run has succeeded and no other run moves files, and fails the run by
  /// throwing. Those of its files that show that results are complete are removed before any file is moved,
  /// and in the end all that this run does not write, so that results never mix. Throws sdm::Error if
  /// `folder` is a file, or cannot be created or written to.
  explicit OutputFolder(const std::filesystem::path& folder, Earlier earlier = {});
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Removes what the folders in use have written, while other threads write: for a process that ends at
  /// once, after Interrupts admits no more Protected work.
  static void discard_current();

  /// Calls `work`, which writes its files below staging(), then moves them to the output folder, replacing
  /// those of an earlier run. Then calls `finish`, still before any other run moves its files. Error messages
  /// contain a file's final path instead of its staged one. Throws what `work` throws, sdm::Error if a folder
  /// has the name of an output file or another run has been moving files for a minute, and sdm::Cancelled
  /// after an interrupt while it waits for that.
  void fill(const std::function<void()>& work, const std::function<void()>& finish = {});
  /// Returns the staged form of `folder`/`subfolder`, and creates it.
  [[nodiscard]] std::filesystem::path staging(const std::filesystem::path& subfolder = {});

 private:
  [[nodiscard]] std::string with_final_path(std::string message) const;
  void commit();
  void remove_traces(const std::filesystem::path& staging);
  void discard();

  static inline std::atomic<OutputFolder*> current_ = nullptr;  ///< the innermost one in use

  OutputFolder* outer_ = nullptr;  ///< in use before this one, and after
  std::filesystem::path folder_, staging_;
  std::shared_ptr<const void> lock_;  ///< on the staging folder
  /// Memory for remove_traces(), released before: too little for a mapping of its own, so it stays available.
  std::unique_ptr<char[]> reserve_{new char[100'000]};
  Earlier earlier_;
  std::filesystem::path existing_;  ///< the closest ancestor of folder_, or itself, that existed before
};

/// Throws sdm::Error if not all of the text could be written.
void write_text(const std::filesystem::path& file, std::string_view text);
/// The same, whole or not at all; directly into what is not a file, such as /dev/stdout.
void write_whole(const std::filesystem::path& file, std::string_view text);
/// Throws sdm::Error about the file, and says that the disk may be full.
[[noreturn]] void throw_write_failure(const std::filesystem::path& file);
