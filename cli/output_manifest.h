// The files that runs have written into an output folder, by which later runs tell them from those of users.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// The file with the list, in the output folder.
inline constexpr const char* kManifestFile = ".sdm-files.json";

/// A file as a run has written it.
struct WrittenFile {
  std::string path{};     ///< relative to the folder
  std::string command{};  ///< whose results it belongs to
  std::uintmax_t bytes = 0;
  std::string xxh3{};
};

/// A file of a run, relative to `folder`, that is at `place` at the moment. Throws sdm::Error if it cannot be
/// read.
[[nodiscard]] WrittenFile written_file(const std::filesystem::path& path, const std::string& command,
                                       const std::filesystem::path& place);

/// The files of the list in the folder. Empty if there is none, or none that is one.
[[nodiscard]] std::vector<WrittenFile> read_manifest(const std::filesystem::path& folder);
[[nodiscard]] std::string manifest_text(const std::vector<WrittenFile>& files);

/// Whether the file is still as it was written, and in the folder, not behind a link.
[[nodiscard]] bool is_unchanged(const std::filesystem::path& folder, const WrittenFile& file);
