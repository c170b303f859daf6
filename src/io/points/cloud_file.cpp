#include "io/points/cloud_file.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "io/file/encodings.h"
#include "io/file/file_bytes.h"
#include "io/mesh/read_polygons.h"
#include "io/points/binary_rows.h"
#include "io/points/cloud_layout.h"
#include "io/points/text/ptx_scans.h"
#include "io/points/text/text_dialect.h"
#include "io/points/text/text_rows.h"
#include "mesh/validate.h"

namespace sdm::io {
namespace {

std::uint64_t open(std::ifstream& stream, const std::filesystem::path& file) {
  require_regular_file(file, "point cloud");
  errno = 0;
  stream.open(file, std::ios::binary);
  if (!stream) throw Error(fmt::format("cannot be opened: {}", std::strerror(errno)));
  const std::uint64_t size = std::filesystem::file_size(file);
  if (size == 0) throw Error("the file is empty");
  return size;
}

void require_no_dialect(const TextDialect& given, std::string_view format) {
  if (is_given(given))
    throw Error(fmt::format(
        "--columns, --separator and --decimal do not apply to {}, which has columns of its own", format));
}

bool has_control_characters(std::string_view bytes) {
  return std::ranges::any_of(
      bytes, [](char c) { return (c >= '\0' && c < ' ' && !(c >= '\t' && c <= '\r')) || c == '\x7f'; });
}

RowPlan plan_of(const CloudLayout& layout) {
  RowPlan plan{.columns = layout.stride};
  const auto& c = layout.columns;
  if (layout.has_normals)
    plan.want({c[0].place, c[1].place, c[2].place, c[3].place, c[4].place, c[5].place});
  else
    plan.want({c[0].place, c[1].place, c[2].place});
  return plan;
}

}  // namespace

void seek(std::ifstream& stream, std::uint64_t place) {
  stream.clear();
  stream.seekg(static_cast<std::streamoff>(place));
}

void take(std::ifstream& stream, char* to, std::size_t count) {
  if (!stream.read(to, static_cast<std::streamsize>(count)))
    throw Error("cannot be read: it became shorter while it was being read");
}

void require_near(const Vec3& point, std::uint64_t number) {
  for (const double x : point)
    if (std::isfinite(x) && std::abs(x) > mesh::kMaxCoordinate)
      throw Error(fmt::format(
          "point {} has a coordinate beyond 1e37, too large for the computation; scale the cloud down",
          number));
}

CloudFile::CloudFile(const std::filesystem::path& file, const TextDialect& given) {
  validate(given);
  const std::uint64_t size = open(stream, file);
  std::string bytes(std::min<std::uint64_t>(size, kMaxCloudHeader), '\0');
  take(stream, bytes.data(), bytes.size());
  refuse_encoded(bytes);
  const std::uint64_t skipped = bytes.starts_with("\xEF\xBB\xBF") ? 3 : 0;  // the UTF-8 byte order mark
  const std::string_view begin = std::string_view(bytes).substr(skipped);

  if (std::optional<CloudLayout> layout = cloud_layout(begin)) {
    require_no_dialect(given, layout->format);
    layout->data_begin += skipped;
    open_declared(bytes, size, *layout);
  } else {
    open_text(begin, skipped, size, given);
  }
}

// PLY, PCD and LAS.
void CloudFile::open_declared(std::string_view begin, std::uint64_t size, const CloudLayout& layout) {
  format = layout.format;
  count = layout.count;
  has_normals = layout.has_normals;
  if (layout.data_begin > size) throw Error("the data begin after the end of the file; it is truncated");
  if (layout.compressed) {
    source = std::make_unique<CompressedColumns>(stream, size, layout);
  } else if (!layout.text) {
    source = std::make_unique<BinaryRows>(stream, size, layout);
  } else {
    const char line_end = line_end_of(begin);
    const auto lines = std::ranges::count(begin.substr(0, layout.data_begin), line_end);
    seek(stream, layout.data_begin);
    source = std::make_unique<DeclaredRows>(
        TextLines(stream, line_end, 1 + static_cast<std::uint64_t>(lines)), plan_of(layout), layout.count);
  }
}

// PTX and text without a format of its own.
void CloudFile::open_text(std::string_view begin, std::uint64_t skipped, std::uint64_t size,
                          const TextDialect& given) {
  // Given columns make text of a file whose first word is one of OBJ or OFF.
  if (const std::string_view mesh = mesh_format_of(begin); !mesh.empty() && given.columns.empty())
    throw Error(fmt::format("this is a mesh ({}), not a point cloud; sdm map measures meshes", mesh));
  if (has_control_characters(begin))
    throw Error(fmt::format("unknown format, not text; {} are supported", point_format_names()));
  seek(stream, skipped);
  TextLines lines(stream, line_end_of(begin), 1);
  if (is_ptx(begin)) {
    format = "PTX";
    require_no_dialect(given, format);
    source = std::make_unique<PtxScans>(std::move(lines), size);
  } else {
    const TextTable table = find_dialect(begin, skipped + begin.size() == size, given);
    format = "text";
    dialect = table.dialect;
    has_normals = table.plan.has_normals();
    source = std::make_unique<TextRows>(std::move(lines), table);
  }
}

}  // namespace sdm::io
