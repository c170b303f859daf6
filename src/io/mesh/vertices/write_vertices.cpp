#include <fmt/format.h>
#include <sdm/map_files.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "core/memory.h"
#include "io/file/atomic_file.h"
#include "io/file/little_endian.h"
#include "io/file/npy.h"
#include "io/mesh/vertices/vertex_columns.h"

namespace sdm {

using namespace io;

namespace {

// Bytes on their way to a file, so that memory does not grow with the number of vertices.
class Buffer {
 public:
  explicit Buffer(std::ostream& stream) : stream_(stream) {}
  ~Buffer() { flush(); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  /// The text to append to.
  std::string& bytes() {
    constexpr std::size_t kMost = 1 << 20;
    if (bytes_.size() > kMost) flush();
    return bytes_;
  }

 private:
  void flush() {
    stream_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    bytes_.clear();
  }

  std::ostream& stream_;
  std::string bytes_;
};

std::string properties(std::span<const VertexColumn> columns) {
  const auto name = [](ChannelType type) {
    return type == ChannelType::float32   ? "float"
           : type == ChannelType::float64 ? "double"
           : type == ChannelType::uint32  ? "uint"
                                          : "uchar";
  };
  std::string lines;
  for (const VertexColumn& column : columns)
    for (std::size_t k = 0; k < column.components; ++k)
      lines += fmt::format("property {} {}\n", name(column.type), component_name(column, k));
  return lines;
}

// The type of a row: that of the only column, or with a field for each.
std::string npy_type(std::span<const VertexColumn> columns) {
  const auto name = [](ChannelType type) {
    return type == ChannelType::float32   ? "<f4"
           : type == ChannelType::float64 ? "<f8"
           : type == ChannelType::uint32  ? "<u4"
                                          : "|u1";
  };
  if (columns.size() == 1 && columns[0].components == 1) return name(columns[0].type);
  std::string fields;
  for (const VertexColumn& column : columns)
    fields += fmt::format("('{}', '{}', ({},)), ", column.name, name(column.type), column.components);
  return '[' + fields + ']';
}

}  // namespace

void write_vertices_ply(const std::filesystem::path& file, const FileVertices& vertices,
                        std::span<const float> vertex_distances) try {
  const std::vector<VertexColumn> columns = vertex_columns(file, vertices, vertex_distances);
  std::uint32_t most_corners = 0;
  for (std::size_t i = 0; i < vertices.ends.size(); ++i)
    most_corners = std::max(most_corners, vertices.ends[i] - (i > 0 ? vertices.ends[i - 1] : 0));
  const bool bytes_suffice = most_corners <= 0xFF;

  AtomicFile out(file);
  out.stream() << "ply\nformat binary_little_endian 1.0\nelement vertex " << vertices.positions.size()
               << "\nproperty double x\nproperty double y\nproperty double z\nproperty float quality\n"
               << properties(columns) << "element face " << vertices.ends.size() << "\nproperty list "
               << (bytes_suffice ? "uchar" : "uint") << " uint vertex_indices\nend_header\n";
  {
    Buffer buffer(out.stream());
    for (std::size_t v = 0; v < vertices.positions.size(); ++v) {
      std::string& bytes = buffer.bytes();
      for (const double x : vertices.positions[v]) append_little_endian(bytes, x);
      columns.front().append(bytes, v);
      for (const VertexColumn& column : columns) column.append(bytes, v);
    }
    std::uint32_t begin = 0;
    for (const std::uint32_t end : vertices.ends) {
      std::string& bytes = buffer.bytes();
      if (bytes_suffice)
        append_little_endian(bytes, static_cast<std::uint8_t>(end - begin));
      else
        append_little_endian(bytes, end - begin);
      for (; begin < end; ++begin) append_little_endian(bytes, vertices.corners[begin]);
    }
  }
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

void write_vertices_csv(const std::filesystem::path& file, const FileVertices& vertices,
                        std::span<const float> vertex_distances) try {
  const std::vector<VertexColumn> columns = vertex_columns(file, vertices, vertex_distances);
  AtomicFile out(file);
  out.stream() << "vertex,x,y,z";
  for (const VertexColumn& column : columns)
    for (std::size_t k = 0; k < column.components; ++k) out.stream() << ',' << component_name(column, k);
  out.stream() << '\n';
  {
    Buffer buffer(out.stream());
    for (std::size_t v = 0; v < vertices.positions.size(); ++v) {
      const Vec3& p = vertices.positions[v];
      std::string& line = buffer.bytes();
      fmt::format_to(std::back_inserter(line), "{},{},{},{}", v, p[0], p[1], p[2]);
      for (const VertexColumn& column : columns) column.append_text(line, v);
      line += '\n';
    }
  }
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

void write_vertices_npy(const std::filesystem::path& file, const FileVertices& vertices,
                        std::span<const float> vertex_distances) try {
  const std::vector<VertexColumn> columns = vertex_columns(file, vertices, vertex_distances);
  AtomicFile out(file);
  out.stream() << npy_header(npy_type(columns), std::array<std::uint64_t, 1>{vertices.positions.size()});
  {
    Buffer buffer(out.stream());
    for (std::size_t v = 0; v < vertices.positions.size(); ++v)
      for (const VertexColumn& column : columns) column.append(buffer.bytes(), v);
  }
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
