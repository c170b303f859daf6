// The results of proximity queries, as JSON and as text. The keys are documented in docs/proximity.md.
#pragma once

#include <sdm/proximity_query.h>

#include <nlohmann/json.hpp>
#include <string>

/// All results of the query, which are computed if necessary.
[[nodiscard]] nlohmann::ordered_json to_json(sdm::ProximityQuery& query);

/// A few lines of text. `size`: of the smaller body, for the digits of places.
[[nodiscard]] std::string summary(sdm::ProximityQuery& query, const std::string& units, double size);
