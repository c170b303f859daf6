// The numbers that a map is summed up to: bands, a histogram, and statistics of parts.
#pragma once

#include <sdm/io.h>
#include <sdm/sdm.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The parts of a surface of one kind: components, or the groups that its file names.
struct PartTable {
  struct Row {
    std::string name;  ///< empty for components, and for the faces without a name
    sdm::PartStatistics part;
    std::uint32_t first_face = 0;
  };

  std::string kind;       ///< "component", or as FaceNames::kind
  std::size_t count = 0;  ///< of all parts
  std::vector<Row> rows;  ///< the largest by area, the largest first; none if there is only one part
};

struct MapNumbers {
  std::optional<sdm::DistanceHistogram> histogram;  ///< nothing without a value
  std::vector<sdm::DistanceBand> bands;             ///< none without edges
  std::vector<PartTable> parts;                     ///< components first
  bool tolerance = false;                           ///< whether there was one
};

/// The edges of the bands around a tolerance: the limits and their halves and doubles on either side of zero;
/// for a tolerance that does not contain zero, the limits, their middle, and as far again beyond them. Those
/// below zero are omitted if distances are unsigned.
[[nodiscard]] std::vector<double> default_bands(const sdm::Tolerance& tolerance, bool is_signed);

/// The mesh that parts are those of.
struct PartSource {
  const sdm::Mesh& mesh;
  std::size_t components;  ///< of the mesh
  std::span<const sdm::FaceNames> names;
  std::span<const std::uint32_t> source_face;  ///< the mesh's face of each of the surface; empty: the same
};

/// `edges`: of the bands; empty for the default ones, if there is a tolerance.
[[nodiscard]] MapNumbers map_numbers(const sdm::Surface& surface, const sdm::DistanceMap& map,
                                     const sdm::DistanceStatistics& distance, const PartSource& source,
                                     std::vector<double> edges,
                                     const std::optional<sdm::Tolerance>& tolerance, double accuracy);

/// "PASS", "FAIL" or "NOT DECIDED".
[[nodiscard]] const char* verdict_name(sdm::Verdict verdict);

[[nodiscard]] nlohmann::ordered_json to_json(const sdm::DistanceStatistics& distance);
[[nodiscard]] nlohmann::ordered_json to_json(const sdm::ToleranceVerdict& verdict);
/// The keys histogram, bands, components and groups.
[[nodiscard]] nlohmann::ordered_json to_json(const MapNumbers& numbers);
