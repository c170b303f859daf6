#include "io/file/file_below.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/excerpt.h"
#include "io/file/error_prefix.h"
#include "io/file/path_below.h"

namespace sdm::io {
namespace {

namespace fs = std::filesystem;

// Both are absolute and have no links.
bool is_inside(const fs::path& file, const fs::path& folder) {
  const auto [in_folder, in_file] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return in_folder == folder.end() && in_file != file.end();
}

}  // namespace

fs::path file_below(const fs::path& folder, std::string_view path, std::string_view what) {
  check_path_below(path, what);
  std::error_code error;
  const fs::path root = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
  if (error) refuse_path(what, path, "the folder of the model cannot be resolved");
  fs::path file = fs::weakly_canonical(root / path, error);
  if (error) refuse_path(what, path, "it cannot be resolved");
  if (!is_inside(file, root))
    refuse_path(what, path, "it is a link to a place outside of the folder of the model");
  return file;
}

bool exists_below(const fs::path& folder, std::string_view path, std::string_view what) {
  std::error_code error;
  return fs::exists(file_below(folder, path, what), error);
}

FileBytes read_below(const fs::path& folder, std::string_view path, std::string_view what) {
  const fs::path file = file_below(folder, path, what);
  return with_error_prefix(fmt::format("{} '{}'", what, excerpt(path)), [&] { return read_bytes(file); });
}

}  // namespace sdm::io
