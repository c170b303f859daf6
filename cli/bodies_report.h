// The results of multi-body queries as a table.
#pragma once

#include <sdm/multi_body_query.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

/// The results for a pair of bodies.
struct PairResults {
  sdm::PairSeparation separation{};
  std::optional<sdm::BoundedLength> penetration_depth{};  ///< none if neither body is a solid
};

/// Those of all pairs that collide or whose separation is at most `max_distance`.
[[nodiscard]] std::vector<PairResults> results_of(sdm::MultiBodyQuery& bodies, double max_distance);

/// A table with one line per pair, below a heading.
[[nodiscard]] std::string table(std::span<const PairResults> pairs);
