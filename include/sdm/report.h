/// report.json, the one form in which files, pages and programs get a Summary. Its keys are documented in
/// docs/report.md. All functions return JSON text; NaN and infinity are null, and bytes of file names that
/// are not UTF-8 are dropped.
///
/// Threads: the functions may be called concurrently.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/names.h>
#include <sdm/summary.h>
#include <sdm/surface.h>
#include <sdm/tessellation.h>
#include <sdm/weld.h>

#include <cstddef>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace sdm {

/// A mesh of a report.
struct ReportedMesh {
  std::string file, transform{};
  MeshInfo info{};
  std::optional<WeldReport> weld{};            ///< if it was welded
  std::optional<Tessellation> tessellation{};  ///< if its file is CAD
  std::string xxh3{};                          ///< of the file, as of file_xxh3(); empty: unknown
};

/// Wall-clock times in milliseconds; nothing where none was taken.
struct ReportTimes {
  std::optional<double> import{}, atlas{}, sites{}, map{}, output{}, total{};
};

template <>
inline constexpr std::tuple kFields<ReportTimes>{Field{"import", &ReportTimes::import, "Reading the meshes."},
                                                 Field{"atlas", &ReportTimes::atlas, "Making the atlas."},
                                                 Field{"sites", &ReportTimes::sites, "Making the sites."},
                                                 Field{"map", &ReportTimes::map, "Computing the map."},
                                                 Field{"export", &ReportTimes::output, "Writing the files."},
                                                 Field{"total", &ReportTimes::total, "All together."}};

/// What a map was computed from, and how.
struct MapReport {
  ReportedMesh on{};               ///< that carries the map
  ReportedMesh to{};               ///< without meaning if Summary::of_itself
  bool on_o1 = true;               ///< `on` is O1
  std::optional<bool> embedded{};  ///< `to` does not intersect itself; if it has an inside
  std::string engine{};
  std::optional<double> precision{};  ///< that was asked for
  std::optional<int> udim{};          ///< the tile of the surface, if it is one
  std::size_t cut_faces = 0;          ///< of `on`, that cross the border of a texture that repeats
  ReportTimes time_ms{};
};

/// Returns report.json of a map: `report`, the atlas of the surface, and summary_json().
[[nodiscard]] SDM_API std::string report_json(const MapReport& report, const Surface& surface,
                                              const Summary& summary);
/// Returns the keys that a summary has in a report.
[[nodiscard]] SDM_API std::string summary_json(const Summary& summary);
/// Returns the value of `o1`, `o2` or `mesh`.
[[nodiscard]] SDM_API std::string mesh_json(const ReportedMesh& mesh);
/// Returns what map.exr states of a map, for ExrOptions::attributes: the meshes of the report, the sign, what
/// the distances are to unless to the closest point, and the units.
[[nodiscard]] SDM_API std::vector<std::pair<std::string, std::string>> exr_attributes(
    const MapReport& report, const DistanceMap& map, const std::string& units);
/// Returns the value of `tessellation`.
[[nodiscard]] SDM_API std::string tessellation_json(const Tessellation& tessellation);

}  // namespace sdm
