#include "research/figures/recording.h"

#include "geometry/vec.h"

namespace sdm::figures {

std::array<Mesh, 2> Recording::meshes(std::size_t frame) const {
  std::array<Mesh, 2> result = first;
  for (int b = 0; b < 2; ++b) result[b].positions = frames[frame][b];
  return result;
}

Box Recording::bounds_of(std::size_t frame) const {
  Box box;
  for (const auto& positions : frames[frame])
    for (const Vec3& p : positions) extend(box, p);
  return box;
}

Recording record(scenes::SceneKind kind, int frames, const std::filesystem::path& mesh,
                 const std::function<void(std::string_view)>& step) {
  scenes::Scene scene(kind, {.mesh = mesh});
  Recording recording;
  for (int b = 0; b < 2; ++b) {
    recording.first[b] = scene.bodies()[b].mesh;
    recording.names[b] = scene.bodies()[b].name;
  }
  for (int frame = 0; frame < frames; ++frame) {
    step("scene");
    if (frame > 0) scene.advance();
    recording.frames.push_back({scene.bodies()[0].mesh.positions, scene.bodies()[1].mesh.positions});
  }
  return recording;
}

}  // namespace sdm::figures
