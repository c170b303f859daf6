// The buffers and accessors of glTF files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io_read/writers.h"

namespace sdm::test {

/// The items of a JSON list.
struct JsonList {
  std::string text;
  std::size_t count = 0;

  /// Returns the index of the item, as text.
  std::string add(const std::string& members) {
    if (count > 0) text += ',';
    text.append("{").append(members).append("}");
    return std::to_string(count++);
  }
};

/// What a glTF file stores; members return the index of what they add, as text.
struct GltfStore {
  std::string buffer;
  JsonList views, accessors;

  static constexpr const char* kVec3 = R"("type":"VEC3","componentType":5126)";

  std::string view(const std::string& bytes) {
    buffer += bytes;
    return views.add(R"("buffer":0,"byteOffset":)" + std::to_string(buffer.size() - bytes.size()) +
                     R"(,"byteLength":)" + std::to_string(bytes.size()));
  }
  std::string accessor(const std::string& type, std::size_t count, const std::string& members) {
    return accessors.add(type + R"(,"count":)" + std::to_string(count) + "," + members);
  }
  /// `rows` rows of a component type, such as `float`, with its code.
  template <typename Component, typename Numbers>
  std::string rows(const std::string& type, std::size_t rows, const Numbers& numbers, int code = 5126,
                   const std::string& members = "") {
    std::string bytes;
    for (const auto x : numbers) put(bytes, static_cast<Component>(x));
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    return accessor(R"("type":")" + type + R"(","componentType":)" + std::to_string(code) + members, rows,
                    R"("bufferView":)" + view(bytes));
  }
  std::string vec3(const std::vector<Vec3>& points) {
    return rows<float>("VEC3", points.size(), coordinates(points));
  }
  /// Stored as differences from nothing; `declared` rows, if that is more than there are.
  std::string sparse_vec3(const std::vector<Vec3>& points, std::size_t declared = 0) {
    std::string indices;
    std::vector<Vec3> values;
    for (std::uint32_t r = 0; r < points.size(); ++r)
      if (points[r] != Vec3{}) {
        put(indices, r);
        values.push_back(points[r]);
      }
    std::string bytes;
    for (const float x : coordinates(values)) put(bytes, x);
    const std::string places = view(indices);
    return accessor(kVec3, std::max(points.size(), declared),
                    R"("sparse":{"count":)" + std::to_string(values.size()) +
                        R"(,"indices":{"componentType":5125,"bufferView":)" + places +
                        R"(},"values":{"bufferView":)" + view(bytes) + "}}");
  }
  std::string scalars(const std::vector<float>& numbers) {
    return rows<float>("SCALAR", numbers.size(), numbers);
  }
  std::string corners(const Mesh& mesh) {
    std::vector<std::uint32_t> all;
    for (const Triangle& t : mesh.triangles) all.insert(all.end(), t.begin(), t.end());
    return rows<std::uint32_t>("SCALAR", all.size(), all, 5125);
  }

  /// The members of a document with these buffers.
  [[nodiscard]] std::string json(const std::string& members, const std::string& buffer_uri = "") const {
    return R"({"asset":{"version":"2.0"},)" + members + R"(,"accessors":[)" + accessors.text +
           R"(],"bufferViews":[)" + views.text + R"(],"buffers":[{"byteLength":)" +
           std::to_string(buffer.size()) + buffer_uri + "}]}";
  }
  [[nodiscard]] std::string glb(const std::string& members) const { return test::glb(json(members), buffer); }

  static std::vector<float> coordinates(const std::vector<Vec3>& points) {
    std::vector<float> numbers;
    for (const Vec3& p : points)
      for (const double x : p) numbers.push_back(static_cast<float>(x));
    return numbers;
  }
};

}  // namespace sdm::test
