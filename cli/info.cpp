#include "info.h"

#include <fmt/format.h>
#include <sdm/mesh.h>
#include <sdm/mesh_files.h>
#include <sdm/sites.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "bounds_text.h"
#include "cad_options.h"
#include "format.h"
#include "notes.h"
#include "output_folder.h"
#include "report.h"
#include "src/io/json/report_json.h"

namespace fs = std::filesystem;

namespace {

struct Options {
  std::string file;
  std::string self_intersections;  ///< file for the pairs; empty: none
  sdm::TessellationOptions tessellation{};
  bool json = false;
};

using FacePairs = std::vector<std::array<std::uint32_t, 2>>;

struct Info {
  sdm::MeshInfo mesh;
  std::optional<sdm::Tessellation> tessellation{};
  Notes notes{};
  std::uint64_t budget = 0;                     ///< of the search for self-intersections, in pairs of faces
  sdm::SelfIntersections self_intersections{};  ///< within it
  std::optional<sdm::BoundedNumber> volume{};   ///< if closed and orientable, and these are known

  [[nodiscard]] bool is_solid() const { return mesh.closed && mesh.orientable; }
};

Info collect(const Options& options) {
  Input input = load_input("mesh", options.file, "", {.tessellation = options.tessellation});
  check_deflection(options.tessellation, {&input});
  Info info{
      .mesh = sdm::inspect(input.mesh), .tessellation = input.tessellation, .notes = std::move(input.notes)};
  const sdm::Sites sites(std::move(input.mesh));
  info.budget = sdm::self_intersection_budget(sites);
  info.self_intersections = sdm::self_intersections(sites, info.budget);
  if (info.is_solid() && info.self_intersections.all)
    info.volume = sdm::solid_volume(sites, {.embedded = info.self_intersections.pairs.empty()});
  return info;
}

constexpr std::size_t kShown = 3;  // pairs of intersecting faces

std::string not_determined(const Info& info) {
  return fmt::format("not determined: more than {} pairs of faces are near each other", info.budget);
}

nlohmann::ordered_json info_json(const std::string& file, const Info& all) {
  const sdm::SelfIntersections& found = all.self_intersections;
  nlohmann::ordered_json json{{"file", file}};
  json.update(sdm::fields_json(all.mesh));
  json["self_intersections"] = nullptr;
  json["least_self_intersections"] = found.pairs.size();
  json["not_determined"] = nullptr;
  if (found.all)
    json["self_intersections"] = found.pairs.size();
  else
    json["not_determined"] = not_determined(all);
  json["volume"] = nullptr;
  if (all.volume) json["volume"] = {{"lower", all.volume->lower}, {"upper", all.volume->upper}};
  json["tessellation"] = nullptr;
  if (all.tessellation) json["tessellation"] = sdm::to_json(*all.tessellation);
  json["notes"] = all.notes;
  return json;
}

std::string text(bool value) {
  return value ? "yes" : "no";
}
constexpr int kInfoDigits = 9;

std::string text(double value) {
  return number(value, kInfoDigits);
}
std::string text(const sdm::Vec3& p, double size) {
  return fmt::format("{}  {}  {}", coordinate(p[0], size, kInfoDigits), coordinate(p[1], size, kInfoDigits),
                     coordinate(p[2], size, kInfoDigits));
}

std::string text(const FacePairs& pairs) {
  if (pairs.empty()) return "none";
  std::string result = fmt::format("{} pair{} of faces: ", pairs.size(), pairs.size() == 1 ? "" : "s");
  for (std::size_t i = 0; i < std::min(kShown, pairs.size()); ++i)
    result += fmt::format("{}{} and {}", i == 0 ? "" : ", ", pairs[i][0], pairs[i][1]);
  return result + (pairs.size() > kShown ? ", ..." : "");
}
std::string self_intersections_text(const Info& info) {
  const sdm::SelfIntersections& found = info.self_intersections;
  if (found.all) return text(found.pairs);
  return found.pairs.empty() ? not_determined(info)
                             : fmt::format("at least {}; {}", text(found.pairs), not_determined(info));
}
std::string volume_text(const Info& info) {
  if (!info.is_solid()) return "none: not closed and orientable";
  if (!info.volume) return "not determined, as the self-intersections";
  if (info.volume->certainty == sdm::Certainty::exact) return text(info.volume->value);
  return bounds_text(info.volume->lower, info.volume->upper, kInfoDigits);
}

void print_table(std::ostream& out, const std::string& file, const Info& all) {
  const sdm::MeshInfo& info = all.mesh;
  const auto row = [&](const char* name, const std::string& value) {
    out << fmt::format("{:<20}{}\n", name, value);
  };
  const sdm::Vec3 &lo = info.bounds.lower, &hi = info.bounds.upper;
  const double size = size_of(info.bounds);
  row("file", file);
  row("vertices", fmt::to_string(info.vertices));
  row("edges", fmt::to_string(info.edges));
  row("triangles", fmt::to_string(info.triangles));
  row("lowest corner", text(lo, size));
  row("highest corner", text(hi, size));
  row("size", text(sdm::Vec3{hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]}, size));
  row("components", fmt::to_string(info.components));
  row("closed", info.closed ? "yes"
                            : fmt::format("no, {} boundary and {} non-manifold edges", info.boundary_edges,
                                          info.nonmanifold_edges));
  row("orientable", text(info.orientable));
  row("oriented", text(info.oriented));
  row("manifold", info.manifold ? "yes"
                                : fmt::format("no, {} non-manifold edges and {} non-manifold vertices",
                                              info.nonmanifold_edges, info.nonmanifold_vertices));
  row("degenerate faces", fmt::to_string(info.degenerate_faces));
  row("duplicate faces", fmt::to_string(info.duplicate_faces));
  row("self-intersections", self_intersections_text(all));
  row("uvs", text(info.has_uvs));
  row("area", text(info.area));
  row("volume", volume_text(all));
  if (all.tessellation) {
    for (const auto& [name, value] : rows_of(*all.tessellation)) row(name, value);
  }
  for (const std::string& note : all.notes) row("note", note);
}

// One pair of face numbers a line.
std::string to_csv(const FacePairs& pairs) {
  std::string csv = "face1,face2\n";
  for (const auto& [a, b] : pairs) csv += fmt::format("{},{}\n", a, b);
  return csv;
}

void run(const Options& options) {
  const Info info = collect(options);
  std::ostringstream table;
  table.exceptions(std::ios::badbit);  // for lack of memory
  std::string text;                    // before the file is written, after which nothing may fail
  if (options.json) {
    text = info_json(options.file, info).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
  } else {
    print_table(table, options.file, info);
    text = table.str();
  }
  if (!options.self_intersections.empty()) {
    if (!info.self_intersections.all)
      throw sdm::Error(fmt::format("{}: the self-intersections are {}; cut the mesh into parts", options.file,
                                   not_determined(info)));
    write_whole(options.self_intersections, to_csv(info.self_intersections.pairs));
  }
  std::cout << text;
}

}  // namespace

void add_info_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "info", "Print counts, bounds, topology, self-intersections, area and volume of a mesh");
  const auto options = std::make_shared<Options>();
  command->add_option("MESH", options->file, fmt::format("The mesh ({})", sdm::mesh_format_names()))
      ->required();
  command->add_flag("--json", options->json, "Print JSON");
  add_deflection_option(*command, options->tessellation);
  command
      ->add_option("--self-intersections", options->self_intersections,
                   "Write all pairs of faces that intersect, numbered from 0, to this CSV file; an error "
                   "where these are not determined, since more than 200 pairs for each face, and more than "
                   "2 million, are near each other")
      ->type_name("FILE");
  command->footer("Example:\n  sdm info scan.ply");
  command->callback([options] { run(*options); });
}
