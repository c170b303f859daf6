#include "info.h"

#include <fmt/format.h>
#include <sdm/io.h>
#include <sdm/mesh.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "format.h"

namespace {

struct Options {
  std::string file;
  bool json = false;
};

nlohmann::ordered_json to_json(const std::string& file, const sdm::MeshInfo& info) {
  return {{"file", file},
          {"vertices", info.vertices},
          {"edges", info.edges},
          {"triangles", info.triangles},
          {"bounds", {{"lo", info.bounds.lo}, {"hi", info.bounds.hi}}},
          {"components", info.components},
          {"closed", info.closed},
          {"orientable", info.orientable},
          {"oriented", info.oriented},
          {"manifold", info.manifold},
          {"boundary_edges", info.boundary_edges},
          {"nonmanifold_edges", info.nonmanifold_edges},
          {"nonmanifold_vertices", info.nonmanifold_vertices},
          {"degenerate_faces", info.degenerate_faces},
          {"duplicate_faces", info.duplicate_faces},
          {"unused_vertices", info.unused_vertices},
          {"uvs", info.has_uvs},
          {"area", info.area},
          {"volume", info.closed && info.orientable ? nlohmann::ordered_json(info.volume) : nullptr}};
}

std::string text(bool value) {
  return value ? "yes" : "no";
}
std::string text(double value) {
  return number(value, 9);
}
std::string text(const sdm::Vec3& value) {
  return fmt::format("{}  {}  {}", text(value[0]), text(value[1]), text(value[2]));
}

void print_table(std::ostream& out, const std::string& file, const sdm::MeshInfo& info) {
  const auto row = [&](const char* name, const std::string& value) {
    out << fmt::format("{:<18}{}\n", name, value);
  };
  const sdm::Vec3 &lo = info.bounds.lo, &hi = info.bounds.hi;
  row("file", file);
  row("vertices", fmt::to_string(info.vertices));
  row("edges", fmt::to_string(info.edges));
  row("triangles", fmt::to_string(info.triangles));
  row("lowest corner", text(lo));
  row("highest corner", text(hi));
  row("size", text(sdm::Vec3{hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]}));
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
  row("uvs", text(info.has_uvs));
  row("area", text(info.area));
  row("volume", info.closed && info.orientable ? text(info.volume) : "none: not closed and orientable");
}

void run(const Options& options) {
  const sdm::MeshInfo info = sdm::inspect(sdm::read_mesh(options.file));
  if (options.json)
    std::cout << to_json(options.file, info).dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
              << '\n';
  else
    print_table(std::cout, options.file, info);
}

}  // namespace

void add_info_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "Print counts, bounds, topology, area and volume of a mesh");
  const auto options = std::make_shared<Options>();
  command->add_option("MESH", options->file, fmt::format("The mesh ({})", sdm::mesh_format_names()))
      ->required();
  command->add_flag("--json", options->json, "Print JSON");
  command->footer("Example:\n  sdm info scan.ply");
  command->callback([options] { run(*options); });
}
