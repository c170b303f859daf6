#include "output_manifest.h"

#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "read_files.h"

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* kAbout =
    "written by sdm: a later run of a command into this folder removes those of its files that are unchanged";

std::string checksum_of(const fs::path& file) {
  const OwnReads results;
  return sdm::file_xxh3(file);
}

bool is_below(const fs::path& path) {
  return path.is_relative() && path.has_filename() && path.lexically_normal() == path &&
         std::ranges::none_of(path, [](const fs::path& part) { return part == ".." || part == "."; });
}

}  // namespace

WrittenFile written_file(const fs::path& path, const std::string& command, const fs::path& place) {
  return {path.generic_string(), command, fs::file_size(place), checksum_of(place)};
}

std::vector<WrittenFile> read_manifest(const fs::path& folder) {
  const fs::path file = folder / kManifestFile;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return {};
  std::ifstream in(file, std::ios::binary);
  const Json json = Json::parse(in, nullptr, false);
  if (!json.is_object() || !json.contains("files") || !json["files"].is_array()) return {};
  std::vector<WrittenFile> files;
  for (const Json& entry : json["files"]) {
    const auto is_text = [&](const char* key) { return entry.contains(key) && entry[key].is_string(); };
    if (!entry.is_object() || !is_text("path") || !is_text("command") || !is_text("xxh3") ||
        !entry.contains("bytes") || !entry["bytes"].is_number_unsigned())
      continue;
    files.push_back({entry["path"].get<std::string>(), entry["command"].get<std::string>(),
                     entry["bytes"].get<std::uintmax_t>(), entry["xxh3"].get<std::string>()});
    if (!is_below(files.back().path)) files.pop_back();
  }
  return files;
}

std::string manifest_text(const std::vector<WrittenFile>& files) {
  Json json{{"about", kAbout}, {"files", Json::array()}};
  for (const WrittenFile& file : files)
    json["files"].push_back(
        {{"path", file.path}, {"command", file.command}, {"bytes", file.bytes}, {"xxh3", file.xxh3}});
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

bool is_unchanged(const fs::path& folder, const WrittenFile& file) try {
  const fs::path path = folder / file.path;
  return fs::is_regular_file(fs::symlink_status(path)) && fs::file_size(path) == file.bytes &&
         fs::canonical(path) == fs::canonical(folder) / file.path && checksum_of(path) == file.xxh3;
} catch (const fs::filesystem_error&) {
  return false;
} catch (const sdm::Error&) {
  return false;
}
