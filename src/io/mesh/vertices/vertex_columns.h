// What files of vertices have for each vertex beside its position.
#pragma once

#include <sdm/map.h>
#include <sdm/mesh_files.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sdm::io {

/// The values of a channel at the vertices of a file, those of one vertex together.
struct VertexColumn {
  std::string name;
  ChannelType type;
  std::size_t components;
  std::vector<std::byte> values;

  [[nodiscard]] std::size_t size() const { return components * size_of(type); }  ///< bytes of a vertex
  /// Appends the bytes of a vertex.
  void append(std::string& bytes, std::size_t vertex) const;
  /// Appends its numbers as text with all digits, each after a comma; nothing for one without a value.
  void append_text(std::string& line, std::size_t vertex) const;
};

/// The columns of the channels that are known at vertices; the first one is the distance. Throws sdm::Error
/// if the distances belong to another mesh; `file` is for the message.
[[nodiscard]] std::vector<VertexColumn> vertex_columns(const std::filesystem::path& file,
                                                       const FileVertices& vertices,
                                                       std::span<const float> distances);

/// The name of component k: that of the column, or with the letter of the component.
[[nodiscard]] std::string component_name(const VertexColumn& column, std::size_t k);

}  // namespace sdm::io
