#include "output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sdm/error.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <exception>
#include <fstream>
#include <functional>
#include <new>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "interrupts.h"
#include "patience.h"
#include "staging_folder.h"

namespace fs = std::filesystem;

namespace {

// In place of operator/ while files are moved: that of libstdc++ 12 frees what it has not made where memory
// is refused to it.
fs::path joined(const fs::path& folder, const fs::path& file) {
  return folder.native() + fs::path::preferred_separator + file.native();
}

/// Files that show that results are complete, or that they can be completed.
bool concludes(const std::string& file) {
  constexpr std::array<std::string_view, 4> kNames{"report.json", "frames.jsonl", "scene.json",
                                                   "resume.state"};
  return std::ranges::find(kNames, fs::path(file).filename().string()) != kNames.end();
}

[[noreturn]] void refuse_to_write(const fs::path& file, const fs::path& input) {
  throw InputConflict(fmt::format("cannot write {}: it is the input {}; choose another name or folder",
                                  file.string(), input.string()));
}

[[noreturn]] void refuse_to_remove(const fs::path& file, const fs::path& input) {
  throw InputConflict(
      fmt::format("cannot remove {}, which an earlier run has written: it is the input {}; choose another "
                  "folder",
                  file.string(), input.string()));
}

void require_writable(const fs::path& file) {
  if (fs::is_directory(file)) cannot_write(file, "a folder with the name of an output file exists");
  if (const auto input = input_at(file)) refuse_to_write(file, *input);
}

/// Removes what must not stay, as well as memory allows.
template <class Work>
void persist(const Work& work) noexcept {
  try {
    patiently(work);
  } catch (const std::exception&) {
  }
}

fs::path without_trailing_slash(fs::path path) {
  path = fs::absolute(path).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& folder, OutputFiles files)
    : folder_(without_trailing_slash(folder)), files_(std::move(files)) {
  if (folder == "-")
    throw sdm::Error("results are files and cannot go to standard output; give a folder with -o");
  std::error_code ignored;
  existing_ = folder_;
  while (!fs::exists(existing_, ignored) && existing_.has_relative_path())
    existing_ = existing_.parent_path();
  if (!fs::is_directory(existing_, ignored)) cannot_write(existing_, "it is not a folder");
  if (existing_ == folder_) {
    plan();
    remove_abandoned(folder_);
  }
  const Interrupts::Protected whole;
  try {
    std::tie(staging_, lock_) = make_staging(folder_);
    outer_ = current_;
    current_ = this;
  } catch (...) {
    persist([&] { remove_traces(staging_); });
    throw;
  }
}

void OutputFolder::discard_current() {
  for (OutputFolder* folder = current_; folder != nullptr; folder = folder->outer_)
    persist([&] { folder->discard(); });
}

// Other threads still write. Under another name of the staging folder they can add no more files, since only
// staging() makes folders, which waits; a file that was being opened meanwhile is found by another attempt.
void OutputFolder::discard() {
  constexpr int kAttempts = 100;
  constexpr auto kStep = std::chrono::milliseconds(5);
  std::error_code error;
  fs::path ended = staging_;
  ended += "-ended";
  fs::rename(staging_, ended, error);
  if (error) ended = staging_;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    remove_traces(ended);
    if (!fs::exists(ended, error)) return;
    std::this_thread::sleep_for(kStep);
  }
}

OutputFolder::~OutputFolder() {
  const Interrupts::Protected whole;
  persist([&] { remove_traces(staging_); });
  current_ = outer_;
}

void OutputFolder::remove_traces(const fs::path& staging) {
  reserve_.reset();
  std::error_code ignored;
  if (!staging.empty()) remove_staging(staging);
  // Folders that contain results are not empty, so they remain.
  for (fs::path made = folder_; made != existing_; made = made.parent_path()) fs::remove(made, ignored);
}

void OutputFolder::fill(const std::function<void()>& work, const std::function<void()>& finish) {
  try {
    work();
    const std::vector<WrittenFile> written = staged_files();
    const auto turn = turn_to_move(folder_);
    commit(written);
    if (finish) finish();
  } catch (const sdm::Cancelled&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const sdm::Error& error) {
    throw sdm::Error(with_final_path(error.what()), error.remedy());
  } catch (const std::exception& error) {
    throw sdm::Error(with_final_path(error.what()));
  }
}

fs::path OutputFolder::staging(const fs::path& subfolder) {
  const Interrupts::Protected whole;
  fs::path path = staging_ / kStagedFiles / subfolder;
  create_folder(path);
  return path;
}

std::string OutputFolder::with_final_path(std::string message) const {
  const std::string hidden =
      fmt::format("{}{}/{}", fs::path::preferred_separator, staging_.filename().string(), kStagedFiles);
  for (std::size_t at; (at = message.find(hidden)) != std::string::npos;) message.erase(at, hidden.size());
  return message;
}

void OutputFolder::plan() {
  for (const fs::path& file : files_.planned) {
    const fs::path path = folder_ / file;
    if (const auto input = input_at(path)) refuse_to_write(path, *input);
    if (const auto identity = identity_of(path)) planned_.try_emplace(*identity, path, std::nullopt);
  }
  if (!has_manifest()) return;
  for (WrittenFile& file : read_manifest(folder_)) {
    if (file.command != files_.command || is_kept(file.path)) continue;
    const fs::path path = folder_ / file.path;
    if (const auto identity = identity_of(path)) planned_.try_emplace(*identity, path, std::move(file));
  }
}

void OutputFolder::require_not_planned(const FileIdentity& identity, const fs::path& input) {
  for (const OutputFolder* folder = current_; folder != nullptr; folder = folder->outer_) {
    const auto found = folder->planned_.find(identity);
    if (found == folder->planned_.end()) continue;
    const auto& [path, obsolete] = found->second;
    if (!obsolete) refuse_to_write(path, input);
    if (is_unchanged(folder->folder_, *obsolete)) refuse_to_remove(path, input);
  }
}

/// The files of this run. Their checksums are needed only where the folder has results.
std::vector<WrittenFile> OutputFolder::staged_files() {
  const fs::path files = staging();
  std::vector<WrittenFile> written;
  for (const auto& entry : fs::recursive_directory_iterator(files)) {
    if (!entry.is_regular_file()) continue;
    const fs::path path = fs::relative(entry.path(), files);
    written.push_back(has_manifest() ? written_file(path, files_.command, entry.path())
                                     : WrittenFile{.path = path.generic_string()});
  }
  // Those that conclude come last.
  std::ranges::stable_partition(written, std::not_fn(concludes), &WrittenFile::path);
  return written;
}

bool OutputFolder::is_kept(const std::string& file) const {
  return files_.keeps && files_.keeps(file);
}

// Results of earlier runs that are neither replaced nor kept.
std::vector<WrittenFile> OutputFolder::obsolete_files(const std::set<std::string>& replaced) const {
  std::vector<WrittenFile> obsolete;
  for (const WrittenFile& file : earlier_)
    if (file.command == files_.command && !replaced.contains(file.path) && !is_kept(file.path))
      obsolete.push_back(file);
  return obsolete;
}

// Before any file is moved.
void OutputFolder::require_no_inputs(const std::vector<WrittenFile>& written,
                                     const std::vector<WrittenFile>& obsolete) const {
  find_inputs_again();
  for (const WrittenFile& file : obsolete)
    if (const auto input = input_at(joined(folder_, file.path)); input && is_unchanged(folder_, file))
      refuse_to_remove(joined(folder_, file.path), *input);
  for (const WrittenFile& file : written) require_writable(joined(folder_, file.path));
  if (has_manifest()) require_writable(joined(folder_, kManifestFile));
}

// Lists the files of earlier runs and of this one.
std::pair<fs::path, fs::path> OutputFolder::staged_manifest(const std::vector<WrittenFile>& written) {
  std::vector<WrittenFile> listed = earlier_;
  listed.insert(listed.end(), written.begin(), written.end());
  fs::path file = joined(staging(), kManifestFile);
  write_text(file, manifest_text(listed));
  return {std::move(file), joined(folder_, kManifestFile)};
}

// The results of earlier runs that conclude are absent while files are moved: where there is one, the results
// are of one run, even if the process is killed here. What can fail for lack of memory or space comes before.
void OutputFolder::commit(const std::vector<WrittenFile>& written) {
  const Interrupts::Protected whole;
  if (files_.check) files_.check();
  if (has_manifest()) earlier_ = read_manifest(folder_);
  std::set<std::string> replaced;
  for (const WrittenFile& file : written) replaced.insert(file.path);
  const std::vector<WrittenFile> obsolete = obsolete_files(replaced);
  require_no_inputs(written, obsolete);
  std::vector<std::pair<fs::path, fs::path>> moves;
  if (has_manifest()) moves.push_back(staged_manifest(written));
  const fs::path staged = staging();
  for (const WrittenFile& file : written)
    moves.emplace_back(joined(staged, file.path), joined(folder_, file.path));
  for (const auto& [from, to] : moves) create_folder(to.parent_path());

  std::error_code ignored;
  for (const WrittenFile& file : obsolete)
    if (concludes(file.path)) remove_unchanged(file);
  for (const WrittenFile& file : written) {
    if (!has_manifest() || !concludes(file.path) || is_kept(file.path)) continue;
    const fs::path path = joined(folder_, file.path);
    if (identity_of(path) && !input_at(path)) fs::remove(path, ignored);
  }
  for (const auto& [from, to] : moves) move_into_place(from, to);
  for (const WrittenFile& file : obsolete)
    persist([&] {
      if (!concludes(file.path)) remove_unchanged(file);
      const fs::path parent = joined(folder_, file.path).parent_path();
      if (parent != folder_) fs::remove(parent, ignored);  // if it is empty
    });
  shorten_manifest(written, replaced);
}

// Until then it also lists what is gone, which does no harm: so nothing that fails here is an error.
void OutputFolder::shorten_manifest(const std::vector<WrittenFile>& written,
                                    const std::set<std::string>& replaced) {
  std::error_code ignored;
  const auto is_gone = [&](const WrittenFile& file) {
    return replaced.contains(file.path) || !fs::exists(joined(folder_, file.path), ignored);
  };
  try {
    if (std::erase_if(earlier_, is_gone) == 0) return;
    const auto [from, to] = staged_manifest(written);
    move_into_place(from, to);
  } catch (const std::exception&) {
  }
}

// What is at the place is taken away in the same step, and looked at: another process can have put an input
// there since all places were checked. Some file systems cannot do that; there the check comes just before.
void OutputFolder::move_into_place(const fs::path& from, const fs::path& to) const {
  constexpr unsigned kNoReplace = 1, kExchange = 2;  // RENAME_NOREPLACE, RENAME_EXCHANGE
  const auto rename_with = [&](unsigned flags) {
    return syscall(SYS_renameat2, AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), flags) == 0 ? 0 : errno;
  };
  int error = 0;
  while ((error = rename_with(kNoReplace)) == EEXIST) {
    error = rename_with(kExchange);
    if (error == ENOENT) continue;  // it has gone meanwhile
    if (error != 0) break;
    const auto input = input_at(from);
    if (input || fs::is_directory(fs::symlink_status(from))) {
      rename_with(kExchange);
      require_writable(to);
      continue;
    }
    std::error_code ignored;
    fs::remove(from, ignored);
    return;
  }
  if (error == 0) return;
  require_writable(to);
  std::error_code failure;
  fs::rename(from, to, failure);
  if (failure) cannot_write(to, failure.message());
}

// Files that were changed are the user's.
void OutputFolder::remove_unchanged(const WrittenFile& file) const {
  const fs::path path = joined(folder_, file.path);
  if (input_at(path) || !is_unchanged(folder_, file)) return;
  std::error_code ignored;
  fs::remove(path, ignored);
}

void OutputFolder::remove_earlier(const fs::path& file) {
  for (const WrittenFile& earlier : earlier_)
    if (earlier.command == files_.command && earlier.path == file) remove_unchanged(earlier);
}

void write_text(const fs::path& file, std::string_view text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw_write_failure(file);
}

void write_whole(const fs::path& path, std::string_view text) {
  if (fs::exists(path) && !fs::is_regular_file(path)) return write_text(path, text);
  const fs::path file = fs::weakly_canonical(fs::absolute(path));  // a link remains one
  OutputFolder out(file.parent_path(), {.planned = {file.filename()}});
  out.fill([&] { write_text(out.staging() / file.filename(), text); });
}

void throw_write_failure(const fs::path& file) {
  throw sdm::Error(fmt::format("cannot write {}: the disk may be full; free space or choose another folder",
                               file.string()));
}
