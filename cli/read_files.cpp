#include "read_files.h"

#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <string>
#include <system_error>
#include <vector>

#include "output_folder.h"
#include "src/io/file/input_files.h"

namespace fs = std::filesystem;

namespace {

struct ReadFiles {
  std::mutex mutex;
  std::map<FileIdentity, fs::path> by_identity;
  std::map<fs::path, fs::path> by_path;  // paths without links, and as they were given
  std::vector<std::string> arguments;
};

ReadFiles& read_files() {
  static ReadFiles files;
  return files;
}

fs::path without_links(const fs::path& file) {
  std::error_code error;
  fs::path path = fs::weakly_canonical(fs::absolute(file, error), error);
  return error ? file : path;
}

thread_local int own_reads = 0;

void note(const fs::path& file) {
  if (own_reads > 0) return;
  const auto identity = identity_of(file);
  if (!identity) return;
  {
    const std::scoped_lock lock(read_files().mutex);
    read_files().by_identity.try_emplace(*identity, file);
    read_files().by_path.try_emplace(without_links(file), file);
  }
  OutputFolder::require_not_planned(*identity, file);
}

}  // namespace

std::optional<FileIdentity> identity_of(const fs::path& file) {
  struct stat info {};
  if (stat(file.c_str(), &info) != 0) return std::nullopt;
  return FileIdentity{info.st_dev, info.st_ino};
}

void watch_inputs(std::span<char* const> arguments) {
  read_files().arguments.assign(arguments.begin(), arguments.end());
  sdm::io::observe_inputs(note);
}

OwnReads::OwnReads() {
  ++own_reads;
}
OwnReads::~OwnReads() {
  --own_reads;
}

std::optional<fs::path> input_at(const fs::path& file) {
  const auto identity = identity_of(file);
  const fs::path path = without_links(file);
  const std::scoped_lock lock(read_files().mutex);
  if (identity)
    if (const auto found = read_files().by_identity.find(*identity); found != read_files().by_identity.end())
      return found->second;
  const auto found = read_files().by_path.find(path);
  if (found == read_files().by_path.end()) return std::nullopt;
  return found->second;
}

void find_inputs_again() {
  const std::scoped_lock lock(read_files().mutex);
  for (const auto& [path, given] : read_files().by_path)
    if (const auto identity = identity_of(path)) read_files().by_identity.try_emplace(*identity, given);
}

bool is_among_arguments(const fs::path& folder) {
  const std::string name = folder.filename().string(), whole = without_links(folder).string() + '/';
  return std::ranges::any_of(read_files().arguments, [&](const std::string& argument) {
    return argument.find(name) != std::string::npos || without_links(argument).string().starts_with(whole);
  });
}
