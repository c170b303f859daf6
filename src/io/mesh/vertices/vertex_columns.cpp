#include "io/mesh/vertices/vertex_columns.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <type_traits>

namespace sdm::io {
namespace {

static_assert(std::endian::native == std::endian::little, "the order of bytes in the files");

template <class T>
void append_number(std::string& line, const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  bool has_value;
  if constexpr (std::is_floating_point_v<T>)
    has_value = !std::isnan(value);
  else
    has_value = value != std::numeric_limits<T>::max();
  if (has_value) fmt::format_to(std::back_inserter(line), "{}", value);
}

}  // namespace

void VertexColumn::append(std::string& bytes, std::size_t vertex) const {
  bytes.append(reinterpret_cast<const char*>(values.data()) + vertex * size(), size());
}

void VertexColumn::append_text(std::string& line, std::size_t vertex) const {
  for (std::size_t k = 0; k < components; ++k) {
    const std::byte* from = values.data() + vertex * size() + k * size_of(type);
    line += ',';
    switch (type) {
      case ChannelType::float32:
        append_number<float>(line, from);
        break;
      case ChannelType::float64:
        append_number<double>(line, from);
        break;
      case ChannelType::uint32:
        append_number<std::uint32_t>(line, from);
        break;
      case ChannelType::uint8:
        append_number<std::uint8_t>(line, from);
        break;
    }
  }
}

std::vector<VertexColumn> vertex_columns(const std::filesystem::path& file, const FileVertices& vertices,
                                         std::span<const float> distances) {
  bool fits = vertices.mesh_vertex.size() == vertices.positions.size();
  for (const std::uint32_t v : vertices.mesh_vertex) fits = fits && (v == kNone || v < distances.size());
  if (!fits)
    throw Error("cannot write " + file.string() + ": the distances of the vertices belong to another mesh");
  DistanceMap at_vertices;
  at_vertices.distance.assign(distances.begin(), distances.end());
  for (float& d : at_vertices.distance)
    if (!std::isfinite(d)) d = std::numeric_limits<float>::quiet_NaN();
  std::vector<Channel> known;
  for (const Channel& channel : channels())
    if (channel.at_vertices) known.push_back(channel);
  auto values = read_channels(known, {.map = &at_vertices}, vertices.mesh_vertex);
  std::vector<VertexColumn> columns;
  for (std::size_t i = 0; i < known.size(); ++i)
    columns.push_back({known[i].name, known[i].type, known[i].components(), std::move(values[i])});
  return columns;
}

std::string component_name(const VertexColumn& column, std::size_t k) {
  return column.components == 1 ? column.name : column.name + '_' + "xyz"[k];
}

}  // namespace sdm::io
