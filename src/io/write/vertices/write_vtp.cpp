// VTK PolyData: VTK file formats, "XML file formats", serial PolyData with appended base64 data.
#include <fmt/format.h>
#include <sdm/io.h>

#include <array>
#include <cstdint>
#include <new>
#include <string>

#include "core/memory.h"
#include "io/write/atomic_file.h"
#include "io/write/little_endian.h"
#include "io/write/vertices/vertex_values.h"

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
  const char* attributes;  ///< of its DataArray
  std::uint64_t bytes;
};

}  // namespace

void write_vertices_vtp(const std::filesystem::path& file, const FileVertices& vertices,
                        std::span<const float> vertex_distances) try {
  const VertexValues values(file, vertices, vertex_distances);
  const std::uint64_t points = vertices.positions.size();
  const std::array<Block, 4> blocks{{{R"(type="Float32" Name="distance")", 4 * points},
                                     {R"(type="Float64" Name="Points" NumberOfComponents="3")", 24 * points},
                                     {R"(type="Int64" Name="connectivity")", 8 * vertices.corners.size()},
                                     {R"(type="Int64" Name="offsets")", 8 * vertices.ends.size()}}};
  std::array<std::string, 4> arrays;
  std::uint64_t offset = 0;  // in characters of base64
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    arrays[i] =
        fmt::format("<DataArray {} format=\"appended\" offset=\"{}\"/>", blocks[i].attributes, offset);
    offset += (sizeof(std::uint64_t) + blocks[i].bytes + 2) / 3 * 4;
  }

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
                              points, vertices.ends.size(), arrays[0], arrays[1], arrays[2], arrays[3]);
  Base64 data(out.stream());
  data.append(blocks[0].bytes);
  for (std::size_t v = 0; v < points; ++v) data.append(values[v]);
  data.end();
  data.append(blocks[1].bytes);
  for (const Vec3& p : vertices.positions)
    for (const double x : p) data.append(x);
  data.end();
  data.append(blocks[2].bytes);
  for (const std::uint32_t v : vertices.corners) data.append(std::int64_t{v});
  data.end();
  data.append(blocks[3].bytes);
  for (const std::uint32_t end : vertices.ends) data.append(std::int64_t{end});
  data.end();
  out.stream() << "\n</AppendedData>\n</VTKFile>\n";
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
