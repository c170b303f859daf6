#include "map_files.h"

#include "core/parallel.h"

#include <sdm/error.h>

#include <fstream>

void write_map_files(const std::filesystem::path& folder, const sdm::Surface& surface,
                     const sdm::DistanceMap& map, std::span<const float> at_vertices,
                     const sdm::PictureOptions& picture, const std::vector<std::function<void()>>& also) {
  std::vector<std::function<void()>> tasks{
      [&] { sdm::write_exr(folder / "map.exr", surface, map); },
      [&] { sdm::write_glb(folder / "model.glb", surface, map, at_vertices, picture); },
      [&] { sdm::write_distance_png(folder / "distance.png", surface, map, picture); },
      [&] { sdm::write_direction_png(folder / "direction.png", surface, map); },
      [&] { sdm::write_voronoi_png(folder / "voronoi.png", surface, map); },
  };
  tasks.insert(tasks.end(), also.begin(), also.end());
  sdm::parallel_for(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) tasks[i]();
  });
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out)
    throw sdm::Error("cannot write " + file.filename().string() + ": the disk may be full; free space on it");
}
