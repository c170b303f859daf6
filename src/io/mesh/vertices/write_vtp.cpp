// VTK PolyData: VTK file formats, "XML file formats", serial PolyData with appended base64 data.
#include <fmt/format.h>
#include <sdm/map_files.h>
#include <sdm/mesh_files.h>

#include <cstdint>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "core/memory.h"
#include "io/file/atomic_file.h"
#include "io/file/little_endian.h"
#include "io/mesh/vertices/vertex_columns.h"

namespace sdm {

using namespace io;

namespace {

// Encodes bytes in base64 as they come.
class Base64 {
 public:
  explicit Base64(std::ostream& stream) : stream_(stream) {}

  template <class T>
  void append(T value) {
    append_little_endian(bytes_, value);
    constexpr std::size_t kMost = 3 << 18;
    if (bytes_.size() >= kMost) encode(bytes_.size() / 3 * 3);
  }
  /// Ends the block, with padding.
  void end() { encode(bytes_.size()); }

 private:
  void encode(std::size_t count) {
    constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    text_.clear();
    for (std::size_t i = 0; i < count; i += 3) {
      std::uint32_t bits = 0;
      for (std::size_t k = i; k < i + 3; ++k)
        bits = bits << 8 | (k < count ? static_cast<unsigned char>(bytes_[k]) : 0u);
      for (std::size_t k = 0; k < 4; ++k) text_ += i + k <= count ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
    }
    stream_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
    bytes_.erase(0, count);
  }

  std::ostream& stream_;
  std::string bytes_, text_;
};

// A block of the appended data: the number of its bytes, and the bytes.
struct Block {
  std::string attributes;  ///< of its DataArray
  std::uint64_t bytes;
};

std::string attributes_of(const VertexColumn& column) {
  const char* type = column.type == ChannelType::float32   ? "Float32"
                     : column.type == ChannelType::float64 ? "Float64"
                     : column.type == ChannelType::uint32  ? "UInt32"
                                                           : "UInt8";
  std::string text = fmt::format(R"(type="{}" Name="{}")", type, column.name);
  if (column.components > 1) text += fmt::format(R"( NumberOfComponents="{}")", column.components);
  return text;
}

}  // namespace

void write_vertices_vtp(const std::filesystem::path& file, const FileVertices& vertices,
                        std::span<const float> vertex_distances) try {
  const std::vector<VertexColumn> columns = vertex_columns(file, vertices, vertex_distances);
  const std::uint64_t points = vertices.positions.size();
  std::vector<Block> blocks;
  for (const VertexColumn& column : columns)
    blocks.push_back({attributes_of(column), column.size() * points});
  blocks.push_back({R"(type="Float64" Name="Points" NumberOfComponents="3")", 24 * points});
  blocks.push_back({R"(type="Int64" Name="connectivity")", 8 * vertices.corners.size()});
  blocks.push_back({R"(type="Int64" Name="offsets")", 8 * vertices.ends.size()});
  std::vector<std::string> arrays;
  std::uint64_t offset = 0;  // in characters of base64
  for (const Block& block : blocks) {
    arrays.push_back(
        fmt::format("<DataArray {} format=\"appended\" offset=\"{}\"/>", block.attributes, offset));
    offset += (sizeof(std::uint64_t) + block.bytes + 2) / 3 * 4;
  }
  const std::size_t of_points = columns.size();  // the blocks after those of the columns

  AtomicFile out(file);
  out.stream() << fmt::format(R"(<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<PolyData>
<Piece NumberOfPoints="{}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{}">
<PointData Scalars="distance">{}</PointData>
<Points>{}</Points>
<Polys>{}{}</Polys>
</Piece>
</PolyData>
<AppendedData encoding="base64">
_)",
                              points, vertices.ends.size(), fmt::join(std::span(arrays).first(of_points), ""),
                              arrays[of_points], arrays[of_points + 1], arrays[of_points + 2]);
  Base64 data(out.stream());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    data.append(blocks[i].bytes);
    for (const std::byte byte : columns[i].values) data.append(static_cast<std::uint8_t>(byte));
    data.end();
  }
  data.append(blocks[of_points].bytes);
  for (const Vec3& p : vertices.positions)
    for (const double x : p) data.append(x);
  data.end();
  data.append(blocks[of_points + 1].bytes);
  for (const std::uint32_t v : vertices.corners) data.append(std::int64_t{v});
  data.end();
  data.append(blocks[of_points + 2].bytes);
  for (const std::uint32_t end : vertices.ends) data.append(std::int64_t{end});
  data.end();
  out.stream() << "\n</AppendedData>\n</VTKFile>\n";
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
