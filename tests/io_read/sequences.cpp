#include "io_read/sequences.h"

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

namespace {

template <typename Numbers>
std::string floats(const Numbers& numbers) {
  std::string bytes;
  for (const auto x : numbers) put(bytes, static_cast<float>(x));
  return bytes;
}

std::string vectors(const std::vector<Vec3>& rows) {
  std::string bytes;
  for (const Vec3& p : rows) bytes += floats(p);
  return bytes;
}

constexpr const char *kVec3 = R"("type":"VEC3","componentType":5126)",
                     *kFloat = R"("type":"SCALAR","componentType":5126)",
                     *kIndex = R"("type":"SCALAR","componentType":5125)";

// The items of a JSON list.
struct List {
  std::string text;
  std::size_t count = 0;

  /// Returns the index of the item, as text.
  std::string add(const std::string& members) {
    if (count > 0) text += ',';
    text.append("{").append(members).append("}");
    return std::to_string(count++);
  }
};

// What a glTF file stores; members return the index of what they add.
struct GltfStore {
  std::string buffer;
  List views, accessors;

  std::string view(const std::string& bytes) {
    buffer += bytes;
    return views.add(R"("buffer":0,"byteOffset":)" + std::to_string(buffer.size() - bytes.size()) +
                     R"(,"byteLength":)" + std::to_string(bytes.size()));
  }
  std::string accessor(const std::string& type, std::size_t count, const std::string& members) {
    return accessors.add(type + R"(,"count":)" + std::to_string(count) + "," + members);
  }
  std::string vec3(const std::vector<Vec3>& rows) {
    return accessor(kVec3, rows.size(), R"("bufferView":)" + view(vectors(rows)));
  }
  std::string sparse_vec3(const std::vector<Vec3>& rows) {
    std::string indices;
    std::vector<Vec3> values;
    for (std::uint32_t r = 0; r < rows.size(); ++r)
      if (rows[r] != Vec3{}) put(indices, r), values.push_back(rows[r]);
    const std::string places = view(indices);
    return accessor(kVec3, rows.size(),
                    R"("sparse":{"count":)" + std::to_string(values.size()) +
                        R"(,"indices":{"componentType":5125,"bufferView":)" + places +
                        R"(},"values":{"bufferView":)" + view(vectors(values)) + "}}");
  }
  std::string scalars(const std::vector<float>& numbers) {
    return accessor(kFloat, numbers.size(), R"("bufferView":)" + view(floats(numbers)));
  }
  std::string corners(const Mesh& mesh) {
    std::string bytes;
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t v : t) put(bytes, v);
    return accessor(kIndex, 3 * mesh.triangles.size(), R"("bufferView":)" + view(bytes));
  }
};

}  // namespace

std::string morph_gltf(const Mesh& mesh, const Frames& targets, const WeightChannel& channel,
                       const std::string& transform, bool sparse) {
  GltfStore store;
  const std::string positions = store.vec3(mesh.positions);
  List target_list;
  for (const std::vector<Vec3>& target : targets)
    target_list.add(R"("POSITION":)" + (sparse ? store.sparse_vec3(target) : store.vec3(target)));
  const std::string indices = store.corners(mesh), input = store.scalars(channel.times),
                    output = store.scalars(channel.values);
  return glb(R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0)" + transform +
                 R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":)" + positions + R"(},"indices":)" +
                 indices + R"(,"targets":[)" + target_list.text +
                 R"(]}]}],"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],)" +
                 R"("samplers":[{"input":)" + input + R"(,"output":)" + output + R"(,"interpolation":")" +
                 channel.interpolation + R"("}]}],"accessors":[)" + store.accessors.text +
                 R"(],"bufferViews":[)" + store.views.text + R"(],"buffers":[{"byteLength":)" +
                 std::to_string(store.buffer.size()) + "}]}",
             store.buffer);
}

}  // namespace sdm::test
