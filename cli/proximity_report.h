// The results of proximity queries as text.
#pragma once

#include <sdm/proximity_query.h>

#include <string>

/// A few lines of text. `size`: of the smaller body, for the digits of places.
[[nodiscard]] std::string summary(sdm::ProximityQuery& query, const std::string& units, double size);
