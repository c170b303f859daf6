#include <fmt/format.h>
#include <lzf.h>
#include <sdm/error.h>
#include <sdm/points.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>
#include <string>

#include "io/points/cloud_layout.h"
#include "io/points/text_numbers.h"
#include "io/read/byte_scanner.h"
#include "io/read/read_polygons.h"

namespace sdm {

using namespace io;

struct PointReader::Impl {
  explicit Impl(const std::filesystem::path& file) : name(file.string()) {
    std::error_code error;
    const auto type = std::filesystem::status(file, error).type();
    if (type == std::filesystem::file_type::not_found) throw Error("there is no such file");
    if (type == std::filesystem::file_type::directory) throw Error("this is a folder, not a point cloud");
    if (error) throw Error(fmt::format("cannot be read: {}", error.message()));
    if (type != std::filesystem::file_type::regular) throw Error("this is not a regular file");
    errno = 0;
    stream.open(file, std::ios::binary);
    if (!stream) throw Error(fmt::format("cannot be opened: {}", std::strerror(errno)));
    size = std::filesystem::file_size(file);
    std::string begin(std::min<std::uint64_t>(size, kMaxCloudHeader), '\0');
    take(begin.data(), begin.size());
    layout = cloud_layout(begin);
    if (layout.data_begin > size) throw Error("the data begin after the end of the file; it is truncated");
    if (layout.compressed)
      decompress();
    else if (layout.count && !layout.text && *layout.count > (size - layout.data_begin) / layout.stride)
      throw Error(fmt::format(
          "the header declares {} points, more than the file can hold; it is truncated or damaged",
          *layout.count));
    if (!layout.compressed) stream.seekg(static_cast<std::streamoff>(layout.data_begin));
    line = 1 + static_cast<std::uint64_t>(
                   std::ranges::count(std::string_view(begin).substr(0, layout.data_begin), '\n'));
    if (layout.count) left = *layout.count;
  }

  void take(char* to, std::size_t count) {
    if (!stream.read(to, static_cast<std::streamsize>(count)))
      throw Error("cannot be read: it became shorter while it was being read");
  }

  // Reads and decompresses the block of a PCD file into `bytes`: LZF has no parts.
  void decompress() {
    constexpr std::uint64_t kMostRatio = 100;  // of LZF: 264 bytes from 3
    std::array<char, 8> sizes{};
    stream.clear();
    stream.seekg(static_cast<std::streamoff>(layout.data_begin));
    const auto truncated = [] { return Error("the compressed data are cut off or damaged"); };
    if (size - layout.data_begin < sizes.size()) throw truncated();
    take(sizes.data(), sizes.size());
    const auto packed = load<std::uint32_t>(sizes.data(), std::endian::little);
    const auto unpacked = load<std::uint32_t>(sizes.data() + 4, std::endian::little);
    if (packed > size - layout.data_begin - sizes.size() || unpacked > kMostRatio * packed ||
        unpacked % layout.stride != 0 || unpacked / layout.stride != *layout.count)
      throw truncated();
    std::vector<char> block(packed);
    take(block.data(), block.size());
    bytes.resize(unpacked);
    if (unpacked > 0 && lzf_decompress(block.data(), packed, bytes.data(), unpacked) != unpacked)
      throw truncated();
  }

  // Points from the columns of `bytes`.
  void read_columns(std::size_t count, std::vector<Vec3>& points, std::vector<Vec3>& normals) {
    points.resize(count);
    normals.resize(layout.has_normals ? count : 0);
    for (std::size_t k = 0; k < (layout.has_normals ? 6u : 3u); ++k) {
      const CloudColumn& column = layout.columns[k];
      const char* first = bytes.data() + *layout.count * column.place;
      for (std::size_t i = 0; i < count; ++i)
        (k < 3 ? points[i][k] : normals[i][k - 3]) =
            number(first + (rows + i) * size_of(column.type), {0, column.type});
    }
    rows += count;
  }

  // Replaces `text` by the next line, without its end. Returns whether there is one.
  bool next_line() {
    ++line;
    return static_cast<bool>(std::getline(stream, text));
  }

  [[noreturn]] void fail_at_line(const std::string& fault) const {
    throw Error(fmt::format("line {}: {}", line - 1, fault));
  }

  double number(const char* row, const CloudColumn& column) const {
    using Type = PlyHeader::Type;
    const char* at = row + column.place;
    switch (column.type) {
      case Type::int8:
        return load<std::int8_t>(at, layout.order);
      case Type::uint8:
        return load<std::uint8_t>(at, layout.order);
      case Type::int16:
        return load<std::int16_t>(at, layout.order);
      case Type::uint16:
        return load<std::uint16_t>(at, layout.order);
      case Type::int32:
        return load<std::int32_t>(at, layout.order);
      case Type::uint32:
        return load<std::uint32_t>(at, layout.order);
      case Type::float32:
        return load<float>(at, layout.order);
      case Type::float64:
        break;
    }
    return load<double>(at, layout.order);
  }

  void read_binary(std::size_t count, std::vector<Vec3>& points, std::vector<Vec3>& normals) {
    bytes.resize(count * layout.stride);
    take(bytes.data(), bytes.size());
    points.resize(count);
    normals.resize(layout.has_normals ? count : 0);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < (layout.has_normals ? 6u : 3u); ++k)
        (k < 3 ? points[i][k] : normals[i][k - 3]) =
            number(bytes.data() + i * layout.stride, layout.columns[k]);
    if (!layout.has_scale) return;
    for (Vec3& p : points)
      for (std::size_t k = 0; k < 3; ++k) p[k] = layout.scale[k] * p[k] + layout.offset[k];
  }

  void read_text(std::size_t count, std::vector<Vec3>& points, std::vector<Vec3>& normals) {
    while (points.size() < count && next_line()) {
      const bool good = numbers_of(text, numbers);
      if (good && numbers.empty()) continue;
      // The number of points, or the names of the columns, in the first line of an XYZ file.
      if (!layout.fixed_columns && rows == 0 && (!good || numbers.size() == 1)) continue;
      const bool wrong_count =
          layout.fixed_columns ? numbers.size() != layout.stride : numbers.size() < layout.stride;
      if (!good || wrong_count)
        fail_at_line(good ? fmt::format("{} numbers where {} are needed", numbers.size(), layout.stride)
                          : "expected numbers only");
      ++rows;
      const auto at = [&](std::size_t k) { return numbers[layout.columns[k].place]; };
      points.push_back({at(0), at(1), at(2)});
      if (layout.has_normals) normals.push_back({at(3), at(4), at(5)});
    }
    if (stream.bad()) throw Error("cannot be read");
    if (layout.count && points.size() < count)
      throw Error(fmt::format("ends after {} of {} points; it is truncated", rows, *layout.count));
  }

  std::string name;
  std::ifstream stream;
  std::uint64_t size = 0, line = 1, rows = 0, left = UINT64_MAX;
  CloudLayout layout;
  std::string text;
  std::vector<char> bytes;
  std::vector<double> numbers;
};

PointReader::PointReader(const std::filesystem::path& file)
    : impl_(with_error_prefix(file.string(), [&] { return std::make_unique<Impl>(file); })) {}
PointReader::~PointReader() = default;
PointReader::PointReader(PointReader&&) noexcept = default;
PointReader& PointReader::operator=(PointReader&&) noexcept = default;

bool PointReader::has_normals() const {
  return impl_->layout.has_normals;
}

std::optional<std::uint64_t> PointReader::count() const {
  return impl_->layout.count;
}

bool PointReader::read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals) {
  return with_error_prefix(impl_->name, [&] {
    points.clear();
    normals.clear();
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(most, impl_->left));
    if (count == 0) return false;
    if (impl_->layout.text)
      impl_->read_text(count, points, normals);
    else if (impl_->layout.compressed)
      impl_->read_columns(count, points, normals);
    else
      impl_->read_binary(count, points, normals);
    if (impl_->layout.count) impl_->left -= count;
    return !points.empty();
  });
}

std::string point_format_names() {
  return "PLY, PCD, LAS, XYZ text";
}

PointSample sample_points(const std::filesystem::path& file, std::size_t most) {
  constexpr std::size_t kChunk = 1 << 16;
  PointReader reader(file);
  PointSample sample;
  std::mt19937_64 random;  // its sequence is that of the standard
  std::uint64_t seen = 0;
  std::vector<Vec3> points, normals;
  while (reader.read(kChunk, points, normals))
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& p = points[i];
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
      // Reservoir sampling, Waterman's algorithm R.
      const std::uint64_t place = seen < most ? seen : random() % (seen + 1);
      ++seen;
      if (place >= most) continue;
      if (place == sample.points.size()) sample.points.emplace_back(), sample.normals.emplace_back();
      sample.points[place] = p;
      if (!normals.empty()) sample.normals[place] = normals[i];
    }
  if (!reader.has_normals()) sample.normals.clear();
  return sample;
}

}  // namespace sdm
