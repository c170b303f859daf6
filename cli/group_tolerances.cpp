#include "group_tolerances.h"

#include <sdm/error.h>
#include <sdm/summary.h>

#include <algorithm>

#include "format.h"
#include "option_checks.h"

using Json = nlohmann::ordered_json;

namespace {

/// Whether a face has the name: those of islands that were left out may be all of a group.
bool has_group(const Input& mesh, const std::string& group) {
  return std::ranges::any_of(mesh.names, [&](const sdm::FaceNames& kind) {
    const auto name = static_cast<std::uint32_t>(std::ranges::find(kind.names, group) - kind.names.begin());
    return std::ranges::count(kind.of_face, name) > 0;
  });
}

std::string some_groups(std::initializer_list<const Input*> meshes) {
  constexpr std::size_t kMost = 20;
  std::vector<std::string> all;
  for (const Input* mesh : meshes)
    for (const sdm::FaceNames& kind : mesh->names)
      all.insert(all.end(), kind.names.begin(), kind.names.end());
  if (all.empty()) return "which has no named groups";
  const bool more = all.size() > kMost;
  all.resize(std::min(all.size(), kMost));
  return fmt::format("which has {}{}", fmt::join(all, ", "), more ? ", ..." : "");
}

Json optional_json(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

// The measured range, and by what a group passes or fails.
std::string group_text(const sdm::GroupVerdict& g, const std::string& units) {
  const std::string unit = unit_suffix(units);
  std::string text = fmt::format("{} ({}): {}, {}", g.group, g.kind, sdm::name_of(g.verdict.verdict),
                                 sdm::limits_text(g.verdict.tolerance, units));
  if (g.lowest) text += fmt::format(", measured {} to {}{}", number(*g.lowest), number(*g.highest), unit);
  if (g.verdict.reason == sdm::VerdictReason::without_match ||
      g.verdict.reason == sdm::VerdictReason::beyond_max_distance ||
      g.verdict.verdict == sdm::Verdict::not_decided)
    text += fmt::format(", {}", sdm::name_of(g.verdict.reason));
  if (g.verdict.verdict == sdm::Verdict::fail)
    text += fmt::format(", {} % of its area is out", number(100 * g.verdict.exceeded_area_fraction));
  if (g.verdict.proof && g.verdict.proof->witness)
    text += fmt::format(", {}{} between the texels", number(g.verdict.proof->witness->distance), unit);
  if (g.verdict.proof && g.verdict.proof->undecided_by)
    text += fmt::format(", not decided by {}{}", number(*g.verdict.proof->undecided_by), unit);
  return text;
}

}  // namespace

void add_tolerance_table_option(CLI::App& app, GroupTolerances& table) {
  app.add_option("--tolerance-table", table.file,
                 "Judge groups of the measured mesh, by the exit code too: CSV with the header "
                 "group,lower,upper, or JSON with these keys. A group is an object, group, material, face or "
                 "color of its file. Faces of no row are judged by --tolerance only")
      ->check(non_empty())
      ->type_name("FILE");
}

void check_groups(const GroupTolerances& table, std::initializer_list<const Input*> meshes) {
  for (const sdm::GroupTolerance& row : table.rows) {
    if (std::ranges::any_of(meshes, [&](const Input* mesh) { return has_group(*mesh, row.group); })) continue;
    throw sdm::Error(fmt::format("{}: {} is no group of {}, the measured mesh, {}", table.file, row.group,
                                 (*meshes.begin())->file, some_groups(meshes)));
  }
}

std::vector<sdm::FaceNames> names_of_part(const std::vector<sdm::FaceNames>& names,
                                          const std::vector<std::uint32_t>& source_face) {
  std::vector<sdm::FaceNames> result = names;
  if (source_face.empty()) return result;
  for (std::size_t k = 0; k < names.size(); ++k) {
    result[k].of_face.clear();
    for (const std::uint32_t face : source_face) result[k].of_face.push_back(names[k].of_face[face]);
  }
  return result;
}

Json to_json(const sdm::GroupVerdicts& verdicts) {
  Json groups = Json::array();
  for (const sdm::GroupVerdict& g : verdicts.groups) {
    const sdm::CertifiedVerdict& v = g.verdict;
    groups.push_back({{"kind", g.kind},
                      {"group", g.group},
                      {"triangles", g.faces},
                      {"lower", v.tolerance.lo},
                      {"upper", v.tolerance.hi},
                      {"verdict", sdm::name_of(v.verdict)},
                      {"reason", sdm::name_of(v.reason)},
                      {"certified", v.certified},
                      {"lowest", optional_json(g.lowest)},
                      {"highest", optional_json(g.highest)},
                      {"exceeded_area_fraction", v.exceeded_area_fraction},
                      {"undecided_by", v.proof ? optional_json(v.proof->undecided_by) : Json()},
                      {"witness", v.proof && v.proof->witness ? Json{{"distance", v.proof->witness->distance},
                                                                     {"point", v.proof->witness->point}}
                                                              : Json()}});
  }
  return {{"verdict", sdm::name_of(verdicts.verdict)}, {"groups", groups}};
}

std::string group_lines(const sdm::GroupVerdicts& verdicts, const std::string& units) {
  std::string text = fmt::format("  groups    {}\n", sdm::name_of(verdicts.verdict));
  for (const sdm::GroupVerdict& g : verdicts.groups)
    text += fmt::format("            {}\n", group_text(g, units));
  return text;
}
