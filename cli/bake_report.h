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

struct BakeResult {
  BakeSurface low{};
  sdm::MatchCounts matches{};  ///< of samples
  BakedChannels channels{};
  Notes notes{};
  BakeTimes time{};
};

/// report.json. Both inputs must be inspected.
[[nodiscard]] nlohmann::ordered_json report_of(const BakeCommand& command, const Input& high,
                                               const Input& low, const BakeResult& result);

/// The summary.
[[nodiscard]] std::string text_of(const BakeCommand& command, const BakeResult& result);
