#include "io/file/path_below.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>

#include "core/excerpt.h"

namespace sdm::io {
namespace {

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

}  // namespace

void check_path_below(std::string_view path, std::string_view what) {
  if (const std::string_view fault = fault_of(path); !fault.empty()) refuse_path(what, path, fault);
}

void refuse_path(std::string_view what, std::string_view path, std::string_view fault) {
  throw Error(fmt::format(
      "the {} '{}' is refused: {}; move it into the folder of the model, and name it relative to that", what,
      excerpt(path), fault));
}

}  // namespace sdm::io
