// One map of `sdm map`: computed, and written.
#pragma once

#include <sdm/sdm.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "alignment.h"
#include "atlas_parts.h"
#include "map_options.h"
#include "report.h"

/// What the tiles of a mesh share.
struct SharedScale {
  sdm::ColorRange colors;
  sdm::PictureOptions texture;
};

/// The measurement of one mesh to the other, which all maps of the mesh share.
struct MapTask {
  MapCommand command;
  Input &on, &to;
  const std::optional<AlignOutcome>& aligned;  ///< how O1 was, if it was
  double import_ms;
  std::vector<sdm::Doubt> doubts{};
  std::optional<sdm::CoverageMap> coverage{};
  std::unique_ptr<sdm::Sites> sites{};  ///< of `to`; null: the first map builds them
  std::optional<SharedScale> shared{};
};

// NOLINTNEXTLINE(bugprone-exception-escape): moving JSON does not throw
struct MapResult {
  Outcome outcome{};
  nlohmann::ordered_json report{};
};

/// The map of a mesh, or of a part of it, and what it takes to write it.
struct ComputedMap {
  std::unique_ptr<sdm::Surface> surface{};
  std::vector<float> at_vertices{};
  sdm::DistanceMap map{};
  Outcome outcome{};    ///< as far as it is known before anything is written
  double accuracy = 0;  ///< of the engine
  double ms = 0;
};

[[nodiscard]] ComputedMap compute_part(MapTask& task, const AtlasPart& part);

/// Writes all files of a map into `folder`. Returns its numbers and its report.
[[nodiscard]] MapResult write_part(const MapTask& task, const AtlasPart& part, const ComputedMap& computed,
                                   const std::filesystem::path& folder);
