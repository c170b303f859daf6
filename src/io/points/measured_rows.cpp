#include "io/points/measured_rows.h"

#include <sdm/error.h>

#include <algorithm>
#include <string_view>

#include "io/file/byte_scanner.h"

namespace sdm::io {
namespace {

constexpr std::size_t kMostHeader = 1024;  // of the files that measure_points() writes
constexpr std::string_view kHeaderEnd = "end_header\n";

MeasuredPoint parsed(const char* row, const RowLayout& layout) {
  MeasuredPoint point;
  for (std::size_t k = 0; k < 3; ++k) {
    point.point[k] = load<double>(row + k * sizeof(double));
    if (layout.has_normals) point.normal[k] = load<float>(row + RowLayout::kNormalAt + k * sizeof(float));
  }
  point.distance = load<float>(row + layout.distance_at());
  point.face = static_cast<std::uint32_t>(load<std::int32_t>(row + layout.face_at()));
  return point;
}

}  // namespace

MeasuredRows::MeasuredRows(const std::filesystem::path& ply, std::uint64_t points, bool has_normals)
    : name_(ply.string()), file_(ply, std::ios::binary), layout_{has_normals}, points_(points) {
  std::string header(kMostHeader, '\0');
  file_.read(header.data(), static_cast<std::streamsize>(header.size()));
  header.resize(static_cast<std::size_t>(file_.gcount()));
  file_.clear();
  const std::size_t end = header.find(kHeaderEnd);
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(ply, error);
  begin_ = end + kHeaderEnd.size();
  if (end == std::string::npos || error || size < begin_ || (size - begin_) / layout_.size() != points ||
      (size - begin_) % layout_.size() != 0)
    throw Error(name_ + ": this is not the file of these measured points");
}

void MeasuredRows::load_rows(std::uint64_t first, std::uint64_t count, std::string& bytes) {
  bytes.resize(static_cast<std::size_t>(count) * layout_.size());
  file_.seekg(static_cast<std::streamoff>(begin_ + first * layout_.size()));
  if (!file_.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    throw Error(name_ + ": the distances cannot be read back");
}

void MeasuredRows::for_each(const std::function<void(std::uint64_t, const MeasuredPoint&)>& visit) {
  constexpr std::uint64_t kRows = 1 << 14;
  std::string bytes;
  for (std::uint64_t first = 0; first < points_; first += kRows) {
    const std::uint64_t count = std::min(kRows, points_ - first);
    load_rows(first, count, bytes);
    for (std::uint64_t i = 0; i < count; ++i)
      visit(first + i, parsed(bytes.data() + i * layout_.size(), layout_));
  }
}

MeasuredPoint MeasuredRows::read(std::uint64_t number) {
  std::string bytes;
  load_rows(number, 1, bytes);
  return parsed(bytes.data(), layout_);
}

}  // namespace sdm::io
