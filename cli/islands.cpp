#include "islands.h"

#include <sdm/error.h>

#include <string_view>
#include <utility>
#include <vector>

#include "format.h"
#include "option_checks.h"

namespace {

constexpr std::string_view kArea = "area:";

/// Reads "COUNT", "SHARE%" or "area:A".
std::optional<sdm::IslandLimits> limits_of(std::string_view text) {
  const bool share = text.ends_with('%'), area = text.starts_with(kArea);
  if (share) text.remove_suffix(1);
  if (area) text.remove_prefix(kArea.size());
  if (!share && !area) {
    const auto count = parse_whole_number(text);
    return count && *count > 0 ? std::optional(sdm::IslandLimits{.faces = static_cast<std::size_t>(*count)})
                               : std::nullopt;
  }
  const auto value = parse_number(text);
  constexpr double kAll = 100;
  if (!value || share == area || !(*value > 0) || (share && *value > kAll)) return std::nullopt;
  return share ? sdm::IslandLimits{.area_fraction = *value / kAll} : sdm::IslandLimits{.area = *value};
}

}  // namespace

namespace {

// 1 for the vertices that have a face of the mesh, but none of the rest of it.
std::vector<std::uint8_t> vertices_left(const sdm::Mesh& mesh, const sdm::Mesh& rest) {
  std::vector<std::uint8_t> left(mesh.positions.size());
  const auto mark = [&](const sdm::Mesh& faces, std::uint8_t value) {
    for (const sdm::Triangle& triangle : faces.triangles)
      if (!sdm::is_removed(triangle))
        for (const std::uint32_t vertex : triangle) left[vertex] = value;
  };
  mark(mesh, 1);
  mark(rest, 0);
  return left;
}

void add_mesh_islands(CLI::App& app, const char* name, const char* help,
                      std::optional<sdm::IslandLimits>& limits) {
  app.add_option_function<std::string>(
         name, [&limits](const std::string& text) { limits = limits_of(text); }, help)
      ->check(CLI::Validator(
          [](const std::string& text) {
            return limits_of(text) ? std::string()
                                   : "'" + text + "' is not a number of faces, SHARE% or area:A above 0";
          },
          ""))
      ->type_name("COUNT|SHARE%|area:A");
}

}  // namespace

void add_island_option(CLI::App& app, std::optional<sdm::IslandLimits>& limits) {
  add_mesh_islands(
      app, "--ignore-islands",
      "Leave out the components of O1 with less than COUNT faces, less than SHARE % of its area, or less "
      "than the area A, before the alignment: floating specks of a scan. Their number is reported",
      limits);
}

void add_island_option_o2(CLI::App& app, std::optional<sdm::IslandLimits>& limits) {
  add_mesh_islands(app, "--ignore-islands-o2",
                   "The same of O2: its islands are no closest points, and nothing is aligned to them",
                   limits);
}

void add_point_island_option(CLI::App& app, std::uint64_t& points) {
  app.add_option(
         "--ignore-islands", points,
         "Leave out the clusters of the cloud with less than COUNT points: floating points of a scan. "
         "They have no distance and count for no number; how many they are is reported")
      ->transform(whole_number(1, std::int64_t{1} << 40))
      ->type_name("COUNT");
}

std::optional<std::string> note_on_islands(const std::string& cloud, const sdm::PointDistances& found) {
  if (!found.islands || found.islands->islands == 0) return std::nullopt;
  const sdm::PointIslands& all = *found.islands;
  std::string note =
      fmt::format("{}: {} with {}, {} % of all, left out", cloud,
                  all.islands == 1 ? "1 island" : fmt::format("{} islands", all.islands),
                  all.points == 1 ? "1 point" : fmt::format("{} points", all.points),
                  number(100 * static_cast<double>(all.points) / static_cast<double>(found.points), 3));
  return note + (found.counted() > 0
                     ? fmt::format("; islands are at least {} from other points", number(all.apart, 3))
                     : "; there are no other points with coordinates");
}

sdm::IslandReport ignore_islands(Input& input, const sdm::IslandLimits& limits) try {
  sdm::WithoutIslands rest = sdm::remove_islands(input.mesh, limits);
  if (rest.islands > 0) input.island_vertices = vertices_left(input.mesh, rest.mesh);
  input.mesh = std::move(rest.mesh);
  for (sdm::FaceNames& kind : input.names) {
    std::vector<std::uint32_t> of_face;
    for (const std::uint32_t face : rest.face) of_face.push_back(kind.of_face[face]);
    kind.of_face = std::move(of_face);
  }
  if (rest.islands > 0)
    input.notes.push_back(
        fmt::format("{}: {} with {}, {} % of the area, left out", input.file,
                    rest.islands == 1 ? "1 island" : fmt::format("{} islands", rest.islands),
                    rest.faces == 1 ? "1 face" : fmt::format("{} faces", rest.faces),
                    number(100 * rest.area_fraction, 3)));
  return rest;
} catch (const sdm::Error& error) {
  throw sdm::Error(input.file + ": " + error.what());
}
