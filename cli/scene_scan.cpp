#include "scene_scan.h"

#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "format.h"
#include "output_folder.h"
#include "scenes/made_scan.h"

namespace {

std::string cloud_text(const std::vector<sdm::Vec3>& points) {
  std::string text;
  for (const sdm::Vec3& p : points) text += fmt::format("{} {} {}\n", p[0], p[1], p[2]);
  return text;
}

nlohmann::ordered_json describe(const std::filesystem::path& part, const sdm::scenes::MadeScan& scan) {
  return {{"scene", "scan"},
          {"part", part.string()},
          {"size", scan.size},
          {"triangles", scan.mesh.triangles.size()},
          {"dent", {{"place", scan.dent_place}, {"depth", scan.dent_depth}, {"radius", scan.dent_radius}}},
          {"noise", scan.noise},
          {"missing_area_fraction", scan.missing},
          {"matrix", scan.placement.rows}};
}

}  // namespace

void write_made_scan(const std::filesystem::path& part, std::size_t triangles,
                     const std::filesystem::path& folder, bool quiet) {
  OutputFolder out(folder,
                   {.command = "scene", .planned = {"part.ply", "scan.ply", "scan.xyz", "scene.json"}});
  sdm::scenes::MadeScan scan;
  out.fill([&] {
    const sdm::Mesh mesh = sdm::read_mesh(part);
    try {
      scan = sdm::scenes::make_scan(mesh, {.triangles = triangles});
    } catch (const sdm::Error& error) {
      throw sdm::Error(part.string() + ": " + error.what());
    }
    sdm::write_mesh(out.staging() / "part.ply", mesh);
    sdm::write_mesh(out.staging() / "scan.ply", scan.mesh);
    write_text(out.staging() / "scan.xyz", cloud_text(scan.mesh.positions));
    write_text(out.staging() / "scene.json", describe(part, scan).dump(2) + '\n');
  });
  if (quiet) return;
  std::cout << fmt::format(
      "A made scan of {} in {}/, described by scene.json:\n"
      "  part.ply   the part, of size {}\n"
      "  scan.ply   {} triangles, with a dent {} deep and noise of {}\n"
      "  scan.xyz   its {} vertices\n",
      part.string(), folder.string(), number(scan.size), scan.mesh.triangles.size(), number(scan.dent_depth),
      number(scan.noise), scan.mesh.positions.size());
}
