#include "module/given_files.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <utility>

#include "core/excerpt.h"
#include "io/file/error_prefix.h"
#include "io/file/file_below.h"
#include "io/file/path_below.h"
#include "io/mesh/formats.h"

namespace sdm::js {
namespace {

const GivenFiles* given = nullptr;

}  // namespace

GivenFiles::GivenFiles(std::map<std::string, std::string_view> files) : files_(std::move(files)) {
  given = this;
}
GivenFiles::~GivenFiles() {
  given = nullptr;
}

std::map<std::string, std::string_view> FileArguments::others() const {
  std::map<std::string, std::string_view> all;
  const char *other = names, *content_of_other = contents;
  for (std::size_t i = 0; i < 2 * std::size_t{files}; i += 2) {
    const std::string path_of_other(other, lengths[i]);
    all[std::filesystem::path(path_of_other).lexically_normal().string()] = {content_of_other,
                                                                             lengths[i + 1]};
    other += lengths[i];
    content_of_other += lengths[i + 1];
  }
  return all;
}

}  // namespace sdm::js

// What the readers call of src/io, for these files.
namespace sdm::io {

std::filesystem::path file_below(const std::filesystem::path&, std::string_view path, std::string_view what) {
  check_path_below(path, what);
  return std::filesystem::path(path).lexically_normal();
}

bool exists_below(const std::filesystem::path& folder, std::string_view path, std::string_view what) {
  return js::given->all().contains(file_below(folder, path, what).string());
}

FileBytes read_bytes(const std::filesystem::path& file) {
  const auto found = js::given->all().find(file.string());
  if (found == js::given->all().end()) throw Error("there is no such file; give it with the option `files`");
  FileBytes bytes{.data = std::make_unique_for_overwrite<char[]>(found->second.size()),
                  .size = found->second.size()};
  std::ranges::copy(found->second, bytes.data.get());
  return bytes;
}

FileBytes read_below(const std::filesystem::path& folder, std::string_view path, std::string_view what) {
  const std::filesystem::path file = file_below(folder, path, what);
  return with_error_prefix(fmt::format("{} '{}'", what, excerpt(path)), [&] { return read_bytes(file); });
}

bool reads_cad() {
  return false;
}
PolygonMesh read_step(std::string_view, const std::filesystem::path&, const TessellationOptions&) {
  throw Error("STEP is read by the command and the Python package only");
}
PolygonMesh read_iges(std::string_view, const std::filesystem::path&, const TessellationOptions&) {
  throw Error("IGES is read by the command and the Python package only");
}

}  // namespace sdm::io
