#include "io/file/file_below.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>

#include "core/excerpt.h"
#include "io/file/error_prefix.h"

namespace sdm::io {
namespace {

namespace fs = std::filesystem;

// A letter, then letters, digits and + - . up to a colon (RFC 3986, 3.1); also the drive of a Windows path.
bool has_scheme(std::string_view path) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const std::size_t colon = path.find(':');
  return colon != std::string_view::npos && colon > 0 && is_letter(path[0]) &&
         std::ranges::all_of(path.substr(0, colon), [&](char c) {
           return is_letter(c) || (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.';
         });
}

bool has_parent_component(std::string_view path) {
  while (!path.empty()) {
    const std::size_t end = std::min(path.find('/'), path.size());
    if (path.substr(0, end) == "..") return true;
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  return false;
}

// What is wrong with the text of the path; empty if nothing is.
std::string_view fault_of(std::string_view path) {
  if (path.empty()) return "it is empty";
  if (path.find('\0') != std::string_view::npos) return "it contains a NUL";
  if (path.find('\\') != std::string_view::npos) return "it contains a backslash";
  if (path.starts_with('/')) return "it is absolute";
  if (has_scheme(path)) return "it has a scheme";
  if (has_parent_component(path)) return "it contains \"..\"";
  return {};
}

// Both are absolute and have no links.
bool is_inside(const fs::path& file, const fs::path& folder) {
  const auto [in_folder, in_file] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return in_folder == folder.end() && in_file != file.end();
}

[[noreturn]] void refuse(std::string_view what, std::string_view path, std::string_view fault) {
  throw Error(fmt::format(
      "the {} '{}' is refused: {}; move it into the folder of the model, and name it relative to that", what,
      excerpt(path), fault));
}

}  // namespace

fs::path file_below(const fs::path& folder, std::string_view path, std::string_view what) {
  if (const std::string_view fault = fault_of(path); !fault.empty()) refuse(what, path, fault);
  std::error_code error;
  const fs::path root = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
  if (error) refuse(what, path, "the folder of the model cannot be resolved");
  fs::path file = fs::weakly_canonical(root / path, error);
  if (error) refuse(what, path, "it cannot be resolved");
  if (!is_inside(file, root))
    refuse(what, path, "it is a link to a place outside of the folder of the model");
  return file;
}

FileBytes read_below(const fs::path& folder, std::string_view path, std::string_view what) {
  const fs::path file = file_below(folder, path, what);
  return with_error_prefix(fmt::format("{} '{}'", what, excerpt(path)), [&] { return read_bytes(file); });
}

}  // namespace sdm::io
