#include "io_read/sequences.h"

#include "io_read/gltf_store.h"
#include "io_read/writers.h"

namespace sdm::test {

Frames frames_of(const Mesh& mesh, std::size_t count) {
  Frames frames;
  for (std::size_t t = 0; t < count; ++t) {
    const double stretch = 1 + 0.25 * static_cast<double>(t);
    std::vector<Vec3>& frame = frames.emplace_back();
    for (const Vec3& p : mesh.positions)
      frame.push_back({stretch * p[0], p[1] - 0.5 * static_cast<double>(t), p[2] / stretch + p[0]});
    for (Vec3& p : frame)
      for (double& x : p) x = static_cast<float>(x);
  }
  return frames;
}

std::string npy_header(const std::string& dictionary) {
  std::string out("\x93NUMPY\1\0", 8);
  put(out, static_cast<std::uint16_t>(dictionary.size() + 1));
  return out + dictionary + '\n';
}

std::string npy(const Frames& frames, const NpyLayout& layout) {
  const std::size_t vertices = frames[0].size();
  std::string out =
      npy_header(std::string("{'descr': '") + (layout.order == std::endian::little ? '<' : '>') + 'f' +
                 std::to_string(layout.number_bytes) +
                 "', 'fortran_order': " + (layout.fortran_order ? "True" : "False") + ", 'shape': (" +
                 std::to_string(frames.size()) + ", " + std::to_string(vertices) + ", 3), }");
  const auto put_number = [&](double x) {
    if (layout.number_bytes == 4)
      put(out, static_cast<float>(x), layout.order);
    else
      put(out, x, layout.order);
  };
  if (layout.fortran_order) {
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t v = 0; v < vertices; ++v)
        for (const auto& frame : frames) put_number(frame[v][k]);
  } else {
    for (const auto& frame : frames)
      for (const Vec3& p : frame)
        for (const double x : p) put_number(x);
  }
  return out;
}

std::string morph_gltf(const Mesh& mesh, const Frames& targets, const WeightChannel& channel,
                       const std::string& transform, bool sparse) {
  GltfStore store;
  const std::string positions = store.vec3(mesh.positions);
  JsonList target_list;
  for (const std::vector<Vec3>& target : targets)
    target_list.add(R"("POSITION":)" + (sparse ? store.sparse_vec3(target) : store.vec3(target)));
  const std::string indices = store.corners(mesh), input = store.scalars(channel.times),
                    output = store.scalars(channel.values);
  return store.glb(
      R"("nodes":[{"mesh":0)" + transform + R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":)" +
      positions + R"(},"indices":)" + indices + R"(,"targets":[)" + target_list.text +
      R"(]}]}],"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],)" +
      R"("samplers":[{"input":)" + input + R"(,"output":)" + output + R"(,"interpolation":")" +
      channel.interpolation + R"("}]}])");
}

}  // namespace sdm::test
