#include "mesh_maps.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "tile_totals.h"

using Json = nlohmann::ordered_json;

namespace {

// As many texels as a map of 8192² has are kept while the others are computed.
constexpr std::size_t kKeptTexels = std::size_t{1} << 26;

using KeptMaps = std::vector<std::optional<ComputedMap>>;

/// Sets the scale of colours to that of all tiles, unless it is given. Returns the maps that were computed
/// for that, as far as they are kept.
KeptMaps share_scale(MapTask& task, const std::vector<AtlasPart>& parts) {
  KeptMaps kept(parts.size());
  if (parts.size() == 1 || task.command.picture.range) return kept;
  TileScale scale;
  std::size_t texels = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    ComputedMap computed = compute_part(task, parts[i]);
    scale.add(*computed.surface, computed.map, computed.accuracy);
    texels += computed.map.distance.size();
    if (texels <= kKeptTexels) kept[i] = std::move(computed);
  }
  task.shared = {scale.colors(task.command.picture), scale.texture(task.command.picture)};
  return kept;
}

std::string tile_name(const AtlasPart& part) {
  return part.udim ? std::to_string(*part.udim) : "";
}

}  // namespace

std::string MeshMaps::folder_of_whole() const {
  return total ? "" : tile_name(parts.front());
}

Json MeshMaps::report() const {
  if (!is_tiled()) return results.front().report;
  Json tiles;
  for (std::size_t i = 0; i < parts.size(); ++i) tiles[tile_name(parts[i])] = results[i].report;
  if (total) tiles["total"] = total->report;
  return tiles;
}

MeshMaps measure_mesh(MapTask task, OutputFolder& out, ProgressLine& progress) {
  task.command.groups.rows = sdm::with_kinds(task.on.names, task.command.groups.rows);
  const MapCommand& command = task.command;
  MeshMaps all{task.on.role, atlas_parts(task.on.mesh, command.layout.atlas)};
  const bool tiled = all.parts.size() > 1;
  if (tiled && !command.layout.cache.empty())
    throw sdm::Error(fmt::format("{}: a mesh with {} UDIM tiles has no single atlas; omit --atlas-cache",
                                 task.on.file, all.parts.size()));
  KeptMaps kept = share_scale(task, all.parts);
  const std::filesystem::path folder = command.both ? task.on.role : "";
  TileTotals totals(command.groups.rows, !task.doubts.empty() && !command.doubts.accept);
  for (std::size_t i = 0; i < all.parts.size(); ++i) {
    const AtlasPart& part = all.parts[i];
    ComputedMap computed = kept[i] ? std::move(*kept[i]) : compute_part(task, part);
    kept[i].reset();
    progress.step("export");
    const MapResult& result =
        all.results.emplace_back(write_part(task, part, computed, out.staging(folder / tile_name(part))));
    if (tiled) totals.add(*part.udim, result.outcome, *computed.surface, computed.map);
  }
  if (!tiled) return all;
  all.total = MapResult{totals.finish(), {}};
  Json& report = all.total->report;
  for (const char* key : {"version", "o1", "o2", "measured_on", "units", "engine", "max_distance"})
    report[key] = all.results.front().report[key];
  report.update(totals.report());
  write_text(out.staging(folder) / "report.json", to_text(report));
  return all;
}

std::string summary(const MeshMaps& maps, const Input& on, const Input& to) {
  std::string text;
  for (std::size_t i = 0; i < maps.parts.size(); ++i) {
    if (maps.parts[i].udim) text += fmt::format("tile {}: ", *maps.parts[i].udim);
    text += summary(on, to, maps.results[i].outcome);
  }
  if (maps.total)
    text += fmt::format("all {} tiles: ", maps.parts.size()) + summary(on, to, maps.total->outcome);
  return text;
}
