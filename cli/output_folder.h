// The output folder of a command, which receives either all files or none.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "output_manifest.h"
#include "read_files.h"

/// What a run writes into a folder.
struct OutputFiles {
  /// Whose results the folder has, so that they never mix: those of an earlier run that this one does not
  /// write are removed, if they are unchanged. Empty: single files in a folder of the user.
  std::string command{};
  /// Files that the run writes in any case, relative to the folder or absolute. That one of them is an input
  /// is found when that is read, and not only when all is computed.
  std::vector<std::filesystem::path> planned{};
  /// Which files of earlier runs belong to this one, too.
  std::function<bool(const std::filesystem::path&)> keeps{};
  /// Is called when this run has succeeded and no other run moves files, and fails the run by throwing.
  std::function<void()> check{};
};

/// Files are first written to a hidden staging folder inside the output folder, and moved into place at the
/// end; those that show that results are complete, such as report.json, come last. After a failure no file
/// remains, and no folder that did not exist before. A process that is killed leaves its staging folder,
/// which the next run into the same folder removes; what else is there, whatever its name is, remains: only
/// files are removed that the manifest of the folder lists, with their checksums. A file that is replaced or
/// removed is never one that the process has read; that is an error before any file is moved.
///
/// Of several runs into one folder, each moves its files while the others wait, so that the files are those
/// of the run that ended last. Where the file system has no locks, such runs must not end at the same time.
class OutputFolder {
 public:
  /// Throws sdm::Error if `folder` is a file, or cannot be created or written to, InputConflict if a planned
  /// file has been read.
  explicit OutputFolder(const std::filesystem::path& folder, OutputFiles files);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Removes what the folders in use have written, while other threads write: for a process that ends at
  /// once, after Interrupts admits no more Protected work.
  static void discard_current();

  /// Throws InputConflict if a folder in use is going to replace or remove the file, which is about to be
  /// read.
  static void require_not_planned(const FileIdentity& identity, const std::filesystem::path& input);

  /// Calls `work`, which writes its files below staging(), then moves them to the output folder, replacing
  /// those of an earlier run. Then calls `finish`, still before any other run moves its files. Error messages
  /// contain a file's final path instead of its staged one. Throws what `work` throws, sdm::Error if a folder
  /// has the name of an output file or another run has been moving files for a minute, and sdm::Cancelled
  /// after an interrupt while it waits for that. An input at the place of a file is an sdm::Error, too.
  void fill(const std::function<void()>& work, const std::function<void()>& finish = {});
  /// Returns the staged form of `folder`/`subfolder`, and creates it.
  [[nodiscard]] std::filesystem::path staging(const std::filesystem::path& subfolder = {});

  /// Removes a file of an earlier run that this one keeps until then, if it is unchanged: from `finish`.
  void remove_earlier(const std::filesystem::path& file);

 private:
  using Path = std::filesystem::path;

  [[nodiscard]] std::string with_final_path(std::string message) const;
  void plan();
  [[nodiscard]] bool has_manifest() const { return !files_.command.empty(); }
  [[nodiscard]] bool is_kept(const std::string& file) const;
  [[nodiscard]] std::vector<WrittenFile> staged_files();
  [[nodiscard]] std::vector<WrittenFile> obsolete_files(const std::set<std::string>& replaced) const;
  void require_no_inputs(const std::vector<WrittenFile>& written,
                         const std::vector<WrittenFile>& obsolete) const;
  [[nodiscard]] std::pair<Path, Path> staged_manifest(const std::vector<WrittenFile>& written);
  void commit(const std::vector<WrittenFile>& written);
  void shorten_manifest(const std::vector<WrittenFile>& written, const std::set<std::string>& replaced);
  void move_into_place(const Path& from, const Path& to) const;
  void remove_unchanged(const WrittenFile& file) const;
  void remove_traces(const std::filesystem::path& staging);
  void discard();

  static inline std::atomic<OutputFolder*> current_ = nullptr;  ///< the innermost one in use

  OutputFolder* outer_ = nullptr;  ///< in use before this one, and after
  std::filesystem::path folder_, staging_;
  std::shared_ptr<const void> lock_;  ///< on the staging folder
  /// Memory for remove_traces(), released before: too little for a mapping of its own, so it stays available.
  std::unique_ptr<char[]> reserve_{new char[100'000]};
  OutputFiles files_;
  std::vector<WrittenFile> earlier_;  ///< of earlier runs; once files are moved
  /// Files that are there and are going to be replaced, or removed if they are unchanged.
  std::map<FileIdentity, std::pair<Path, std::optional<WrittenFile>>> planned_;
  std::filesystem::path existing_;  ///< the closest ancestor of folder_, or itself, that existed before
};

/// Throws sdm::Error if not all of the text could be written.
void write_text(const std::filesystem::path& file, std::string_view text);
/// The same, whole or not at all; directly into what is not a file, such as /dev/stdout.
void write_whole(const std::filesystem::path& file, std::string_view text);
/// Throws sdm::Error about the file, and says that the disk may be full.
[[noreturn]] void throw_write_failure(const std::filesystem::path& file);
