// What `sdm bake` reports.
#pragma once

#include <sdm/match.h>

#include <nlohmann/json.hpp>
#include <string>

#include "bake_channels.h"
#include "bake_options.h"
#include "bake_surface.h"
#include "notes.h"
#include "report.h"

struct BakeTimes {
  double import = 0, match = 0, bake = 0, output = 0, total = 0;
};

/// The numbers of samples that faces own, by how a point was found for them.
struct MatchCounts {
  std::size_t closest = 0, facing = 0, ray = 0, too_far = 0, facing_away = 0;

  [[nodiscard]] std::size_t matched() const { return closest + facing + ray; }
};

[[nodiscard]] MatchCounts counts_of(const sdm::TexelMatches& matches);

struct BakeResult {
  BakeSurface low{};
  MatchCounts matches{};
  BakedChannels channels{};
  Notes notes{};
  BakeTimes time{};
};

/// report.json. Both inputs must be inspected.
[[nodiscard]] nlohmann::ordered_json report_of(const BakeCommand& command, const Input& high,
                                               const Input& low, const BakeResult& result);

/// The summary.
[[nodiscard]] std::string text_of(const BakeCommand& command, const BakeResult& result);
