#include "sequence_state.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <fstream>
#include <new>
#include <string>
#include <type_traits>
#include <utility>

#include "output_folder.h"

using Json = nlohmann::ordered_json;

namespace {

constexpr std::uint64_t kStart = 0xcbf29ce484222325;

std::uint64_t mix(std::uint64_t hash, std::uint64_t word) {
  hash = (hash ^ word) * 0x9e3779b97f4a7c15;  // odd, hence invertible: every word counts
  return hash ^ hash >> 32;
}

template <class T>
void write_array(std::ofstream& out, const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  out.write(reinterpret_cast<const char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(T)));
}

template <class T>
void read_array(std::ifstream& in, std::vector<T>& values, std::size_t count) {
  values.resize(count);
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
}

Json hash_json(const std::optional<std::uint64_t>& hash) {
  return hash ? Json(*hash) : Json(nullptr);
}

std::optional<std::uint64_t> hash_from(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<std::uint64_t>());
}

}  // namespace

std::uint64_t hash_of(std::span<const sdm::Vec3> positions) {
  std::uint64_t hash = kStart;
  for (const sdm::Vec3& p : positions)
    for (const double x : p) hash = mix(hash, std::bit_cast<std::uint64_t>(x));
  return mix(hash, positions.size());
}

std::uint64_t hash_of(const sdm::Mesh& mesh) {
  std::uint64_t hash = hash_of(mesh.positions);
  for (const auto& [a, b, c] : mesh.triangles) hash = mix(mix(hash, std::uint64_t{a} << 32 | b), c);
  return hash;
}

// One line of JSON, followed by the arrays of the maps over time.
void SequenceState::write(const std::filesystem::path& file) const {
  Json header{{"options", options}, {"meshes", meshes}, {"frames", Json::array()}};
  for (const Frame& frame : frames)
    header["frames"].push_back(
        {{"line", frame.line}, {"hash", {hash_json(frame.hash[0]), hash_json(frame.hash[1])}}});
  const sdm::TemporalMaps::State& maps = temporal.state();
  header["maps"] = maps.maps;
  header["resolution"] = maps.resolution;
  header["first_resolution"] = resolution;
  header["texels"] = maps.sum.size();
  std::ofstream out(file, std::ios::binary);
  out << header.dump() << '\n';
  write_array(out, maps.least);
  write_array(out, maps.largest);
  write_array(out, maps.sum);
  out.close();
  if (!out) throw_write_failure(file);
}

SequenceState SequenceState::read(const std::filesystem::path& file) try {
  if (!std::filesystem::is_regular_file(file)) throw sdm::Error("it is not a regular file");
  std::ifstream in(file, std::ios::binary);
  std::string line;
  std::getline(in, line);
  const Json header = Json::parse(line);
  SequenceState state;
  state.options = header.at("options");
  state.meshes = header.at("meshes");
  for (const Json& frame : header.at("frames"))
    state.frames.push_back(
        {frame.at("line"), {hash_from(frame.at("hash").at(0)), hash_from(frame.at("hash").at(1))}});
  state.resolution = header.at("first_resolution");
  sdm::TemporalMaps::State maps;
  maps.maps = header.at("maps");
  maps.resolution = header.at("resolution");
  const std::size_t texels = header.at("texels");
  constexpr std::size_t kBytesPerTexel = 2 * sizeof(float) + sizeof(double);
  const std::uintmax_t size = std::filesystem::file_size(file);
  const std::uintmax_t rest = size - std::min<std::uintmax_t>(size, line.size() + 1);
  if (rest % kBytesPerTexel != 0 || rest / kBytesPerTexel != texels) throw sdm::Error("size");
  read_array(in, maps.least, texels);
  read_array(in, maps.largest, texels);
  read_array(in, maps.sum, texels);
  if (!in) throw sdm::Error("not read");
  state.temporal = sdm::TemporalMaps(std::move(maps));
  return state;
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception&) {
  throw sdm::Error(fmt::format("{} is damaged; omit --resume to start again", file.string()));
}

std::optional<SequenceState> incomplete_run(const std::filesystem::path& folder, const Json& options) {
  const std::filesystem::path file = folder / SequenceState::kFile;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return std::nullopt;
  SequenceState state = SequenceState::read(file);
  for (const auto& [name, value] : options.items()) {
    const Json was = state.options.value(name, Json());
    if (was == value) continue;
    const std::string what = name == "version" ? "version of sdm" : name;
    refuse_to_resume(folder, fmt::format("the interrupted run had another {} ({}, now {})", what, was.dump(),
                                         value.dump()));
  }
  return state;
}

void refuse_to_resume(const std::filesystem::path& folder, const std::string& reason) {
  throw sdm::Error(
      fmt::format("cannot resume in {}: {}; omit --resume to start again", folder.string(), reason));
}
