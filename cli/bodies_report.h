// The results of multi-body queries, as JSON and as a table. The keys are documented in docs/proximity.md.
#pragma once

#include <sdm/multi_body_query.h>

#include <nlohmann/json.hpp>
#include <span>
#include <string>

[[nodiscard]] nlohmann::ordered_json to_json(const sdm::PairProximity& pair);
[[nodiscard]] nlohmann::ordered_json to_json(const sdm::BodyContact& contact);

/// A table with one line per pair, below a heading.
[[nodiscard]] std::string table(std::span<const sdm::PairProximity> pairs);
