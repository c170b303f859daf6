// VTK ImageData: VTK file formats, "XML file formats", serial ImageData with raw appended data.
#include <fmt/format.h>

#include <cstdint>

#include "io/fields/formats.h"
#include "io/fields/numbers.h"

namespace sdm::io {
namespace {

// A block of the appended data: the number of its bytes, and the bytes.
template <class T>
void write_block(std::ostream& out, std::span<const T> numbers) {
  write_numbers<std::uint64_t>(out, std::array<std::uint64_t, 1>{numbers.size_bytes()});
  write_numbers<T>(out, numbers);
}

}  // namespace

void write_field_vti(std::ostream& out, const DistanceField& field) {
  const Grid& grid = field.grid;
  std::uint64_t offset = 0;
  const auto array = [&](const char* type, const char* name, std::size_t bytes) {
    const std::string text = fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" format=\"appended\" offset=\"{}\"/>\n", type, name, offset);
    offset += sizeof(std::uint64_t) + bytes;
    return text;
  };
  std::string arrays = array("Float32", "distance", 4 * field.distance.size());
  if (!field.site.empty()) {
    arrays += array("UInt32", "site", 4 * field.site.size());
    arrays += array("UInt8", "site_type", field.site_type.size());
  }
  const std::string extent =
      fmt::format("0 {} 0 {} 0 {}", grid.dims[0] - 1, grid.dims[1] - 1, grid.dims[2] - 1);
  out << fmt::format(R"(<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<ImageData WholeExtent="{}" Origin="{} {} {}" Spacing="{} {} {}">
<Piece Extent="{}">
<PointData Scalars="distance">
{}</PointData>
</Piece>
</ImageData>
<AppendedData encoding="raw">
_)",
                     extent, grid.origin[0], grid.origin[1], grid.origin[2], grid.spacing[0], grid.spacing[1],
                     grid.spacing[2], extent, arrays);
  write_block<float>(out, field.distance);
  if (!field.site.empty()) {
    write_block<std::uint32_t>(out, field.site);
    write_block<std::uint8_t>(
        out, {reinterpret_cast<const std::uint8_t*>(field.site_type.data()), field.site_type.size()});
  }
  out << "\n</AppendedData>\n</VTKFile>\n";
}

}  // namespace sdm::io
