#include "output_folder.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <exception>
#include <fstream>
#include <functional>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& fault) {
  throw sdm::Error(
      fmt::format("cannot write to {}: {}; choose another folder with -o", path.string(), fault));
}

void create_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) fail(path, error.message());
}

constexpr std::string_view kPrefix = ".sdm-", kSuffix = ".part";  // around the number of the process

// Removes the staging folders of processes that were killed: those that no longer run on this machine. Others
// may share the folder, so staging folders that were written to a short time ago remain.
void remove_abandoned(const fs::path& folder) {
  constexpr auto kShort = std::chrono::minutes(1);
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) continue;
    pid_t process = 0;
    const char* number = name.data() + kPrefix.size();
    const char* end = name.data() + name.size() - kSuffix.size();
    if (number >= end || std::from_chars(number, end, process).ptr != end || process <= 0) continue;
    if (kill(process, 0) == 0 || errno != ESRCH) continue;
    const auto written = fs::last_write_time(entry.path(), error);
    if (!error && fs::file_time_type::clock::now() - written > kShort) fs::remove_all(entry.path(), error);
  }
}

fs::path without_trailing_slash(fs::path path) {
  path = fs::absolute(path).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& folder, std::vector<fs::path> earlier)
    : folder_(without_trailing_slash(folder)),
      staging_(folder_ / fmt::format("{}{}{}", kPrefix, getpid(), kSuffix)),
      earlier_(std::move(earlier)) {
  if (folder == "-")
    throw sdm::Error("results are files and cannot go to standard output; give a folder with -o");
  std::error_code ignored;
  existing_ = folder_;
  while (!fs::exists(existing_, ignored) && existing_.has_relative_path())
    existing_ = existing_.parent_path();
  if (!fs::is_directory(existing_, ignored)) fail(existing_, "it is not a folder");
  if (existing_ == folder_) remove_abandoned(folder_);
  try {
    std::error_code error;
    fs::create_directories(staging_, error);
    if (error) fail(folder_, error.message());
    current_ = this;
  } catch (...) {
    remove_traces();
    throw;
  }
}

void OutputFolder::discard_current() {
  if (current_) current_->remove_traces();
}

OutputFolder::~OutputFolder() {
  current_ = nullptr;
  remove_traces();
}

void OutputFolder::remove_traces() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  // Folders that contain results are not empty, so they remain.
  for (fs::path made = folder_; made != existing_; made = made.parent_path()) fs::remove(made, ignored);
}

void OutputFolder::fill(const std::function<void()>& work) {
  try {
    work();
    commit();
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
  fs::path path = staging_ / subfolder;
  create_folder(path);
  return path;
}

std::string OutputFolder::with_final_path(std::string message) const {
  const std::string hidden = fs::path::preferred_separator + staging_.filename().string();
  for (std::size_t at; (at = message.find(hidden)) != std::string::npos;) message.erase(at, hidden.size());
  return message;
}

void OutputFolder::commit() {
  std::vector<std::pair<fs::path, fs::path>> moves;
  for (const auto& entry : fs::recursive_directory_iterator(staging_)) {
    if (!entry.is_regular_file()) continue;
    moves.emplace_back(entry.path(), folder_ / fs::relative(entry.path(), staging_));
    if (fs::is_directory(moves.back().second))
      fail(moves.back().second, "a folder with the name of an output file exists");
  }
  // The report is absent while files are moved: where there is one, the results are complete and of one run,
  // even if the process is killed here.
  const auto is_report = [](const auto& move) { return move.second.filename() == "report.json"; };
  std::ranges::stable_partition(moves, std::not_fn(is_report));
  for (const auto& [from, to] : moves) create_folder(to.parent_path());
  std::error_code ignored;
  for (const auto& move : moves)
    if (is_report(move)) fs::remove(move.second, ignored);
  for (const auto& [from, to] : moves) {
    std::error_code error;
    fs::rename(from, to, error);
    if (error) fail(to, error.message());
  }
  for (const fs::path& file : earlier_) {
    const fs::path stale = folder_ / file;
    if (std::ranges::find(moves, stale, &std::pair<fs::path, fs::path>::second) != moves.end()) continue;
    fs::remove(stale, ignored);
    if (stale.parent_path() != folder_) fs::remove(stale.parent_path(), ignored);  // if it is empty
  }
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw_write_failure(file);
}

void throw_write_failure(const fs::path& file) {
  throw sdm::Error(fmt::format("cannot write {}: the disk may be full; free space or choose another folder",
                               file.string()));
}
