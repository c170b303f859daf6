// A file of points, and how it is read.
#pragma once

#include <sdm/points.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "io/points/cloud_layout.h"
#include "io/points/text/point_source.h"

namespace sdm::io {

/// Moves to a place in the file.
void seek(std::ifstream& stream, std::uint64_t place);
/// Reads bytes. Throws sdm::Error if there are fewer.
void take(std::ifstream& stream, char* to, std::size_t count);

/// Throws sdm::Error for a point that is too far away to be measured. `number`: its place in the file.
void require_near(const Vec3& point, std::uint64_t number);

struct CloudFile {
  /// Opens a file of any format of points. Throws sdm::Error, which does not name the file.
  CloudFile(const std::filesystem::path& file, const TextDialect& given);

  std::ifstream stream;
  std::string format;
  std::optional<TextDialect> dialect;
  std::optional<std::uint64_t> count;
  bool has_normals = false;
  std::unique_ptr<PointSource> source;  ///< refers to `stream`

 private:
  void open_declared(std::string_view begin, std::uint64_t size, const CloudLayout& layout);
  void open_text(std::string_view begin, std::uint64_t skipped, std::uint64_t size, const TextDialect& given);
};

}  // namespace sdm::io
