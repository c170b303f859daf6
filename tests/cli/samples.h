// Small meshes as files, for runs of the command.
#pragma once

#include <sdm/map_files.h>

#include <algorithm>
#include <fstream>
#include <vector>

#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {

inline std::string write_obj(const std::filesystem::path& file, const Mesh& mesh) {
  std::ofstream out(file);
  out.precision(17);
  for (const Vec3& p : mesh.positions) out << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  for (const Triangle& t : mesh.triangles)
    out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  return file.string();
}

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Where a folder has the list of the files that runs have written into it.
constexpr const char* kManifest = ".sdm-files.json";

/// The names in a folder, sorted, without the manifest.
inline std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().filename() != kManifest) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

inline const std::vector<std::string> kResults = [] {
  std::vector<std::string> names{"atlas_direction.png", "atlas_distance.png", "atlas_voronoi.png", "map.exr",
                                 "model.glb",           "report.json",        "views.png"};
  if (can_write_html()) names.insert(names.begin() + 5, "report.html");
  return names;
}();

/// Two tori, the second one of them 0.3 units to the right of the first: they cross.
struct TwoTori {
  TemporaryFolder folder;
  std::string o1 = write_obj(folder / "first.obj", ring(12)),
              o2 = write_obj(folder / "second.obj", ring(16, 1, {0.3, 0, 0}));
  std::string out = folder / "out";

  /// The arguments of a run, `more` appended.
  [[nodiscard]] std::vector<std::string> map(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"map", o1, o2, "-o", out};
    const auto sets_resolution = [](const std::string& a) {
      return a == "--resolution" || a == "--precision";
    };
    if (std::ranges::none_of(more, sets_resolution)) more.insert(more.end(), {"--resolution", "128"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

}  // namespace sdm::test
