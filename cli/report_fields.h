// --field: facts that the author of a report states, such as part numbers.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

/// Names and texts, in the order in which they were given.
using ReportFields = std::vector<std::pair<std::string, std::string>>;

/// Adds --field NAME=TEXT, which may be repeated. Fails the parsing if a name is missing or occurs twice.
void add_field_option(CLI::App& app, ReportFields& fields);

/// Puts them into a report as `fields`, unless there are none.
void put_fields(nlohmann::ordered_json& report, const ReportFields& fields);
