// --tolerance-table: groups of the measured mesh with a tolerance each.
#pragma once

#include <sdm/doubts.h>
#include <sdm/tolerance.h>
#include <sdm/verdict.h>

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "report.h"

/// The file, and what it has once it was read.
struct GroupTolerances {
  std::string file;
  std::vector<sdm::GroupTolerance> rows{};
};

/// Adds --tolerance-table; `what` it judges begins its help.
void add_tolerance_table_option(CLI::App& app, GroupTolerances& table,
                                const std::string& what =
                                    "Judge groups of the measured mesh, by the exit "
                                    "code too");

/// States that no face of a mesh has the name, and which names there are.
[[nodiscard]] std::string no_group(const std::string& name, const Input& mesh);

/// States the share of the area of a mesh whose faces are of no row, if some faces are.
[[nodiscard]] std::optional<std::string> note_on_unjudged(const GroupTolerances& table, const Input& mesh);

/// Throws sdm::Error for a row whose group none of the meshes has, naming groups that they have.
void check_groups(const GroupTolerances& table, std::initializer_list<const Input*> meshes);

/// The verdicts and the sentence on all of them; `summary`: of the same map or cloud.
[[nodiscard]] nlohmann::ordered_json groups_json(const sdm::GroupVerdicts& verdicts,
                                                 const sdm::Summary& summary);

/// One line for each group.
[[nodiscard]] std::string group_lines(const sdm::GroupVerdicts& verdicts, const sdm::Summary& summary);

/// Adds the doubt that thin walls leave, if one of the groups has it.
void add_group_doubts(const sdm::GroupVerdicts& groups, std::vector<sdm::Doubt>& doubts);
