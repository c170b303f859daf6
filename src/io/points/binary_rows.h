// Points from the rows, or the compressed columns, of binary files.
#pragma once

#include <cstdint>
#include <fstream>
#include <vector>

#include "io/points/cloud_layout.h"
#include "io/points/text/point_source.h"

namespace sdm::io {

class BinaryRows final : public PointSource {
 public:
  /// `size`: of the file in bytes. Throws sdm::Error if it cannot have the points that the layout declares.
  BinaryRows(std::ifstream& stream, std::uint64_t size, const CloudLayout& layout);
  void read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals) override;

 private:
  std::ifstream& stream_;
  CloudLayout layout_;
  std::uint64_t left_;
  std::vector<char> bytes_;
};

/// Binary_compressed PCD. Memory: all of its data, as LZF has no parts.
class CompressedColumns final : public PointSource {
 public:
  /// Reads and decompresses the data. Throws sdm::Error.
  CompressedColumns(std::ifstream& stream, std::uint64_t size, const CloudLayout& layout);
  void read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals) override;

 private:
  CloudLayout layout_;
  std::uint64_t rows_ = 0;
  std::vector<char> bytes_;
};

}  // namespace sdm::io
