// The files that this process has read, which it must neither replace nor remove.
#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>

/// Which file a path leads to, whatever its name: hard and symbolic links to a file, and names in another
/// case where the file system ignores it, have one identity.
struct FileIdentity {
  std::uint64_t device = 0, number = 0;
  auto operator<=>(const FileIdentity&) const = default;
};
/// Nothing if there is no such file.
[[nodiscard]] std::optional<FileIdentity> identity_of(const std::filesystem::path& file);

/// A file to be written or removed is an input. Not an sdm::Error, which some commands survive.
class InputConflict : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Begins to note what is read: before anything is. `arguments`: those of the command line.
void watch_inputs(std::span<char* const> arguments);

/// During its lifetime, what this thread reads are results.
class OwnReads {
 public:
  OwnReads();
  ~OwnReads();
  OwnReads(const OwnReads&) = delete;
  OwnReads& operator=(const OwnReads&) = delete;
};

/// The input that this file is, by identity or by its path. Nothing if it is none so far.
[[nodiscard]] std::optional<std::filesystem::path> input_at(const std::filesystem::path& file);

/// Finds inputs again that have been replaced since they were read, for input_at().
void find_inputs_again();

/// Whether an argument of the command line leads into the folder, so that files in it are going to be read.
[[nodiscard]] bool is_among_arguments(const std::filesystem::path& folder);
