// The elements of an accessor.
#pragma once

#include <sdm/types.h>

#include <cstddef>
#include <nlohmann/json_fwd.hpp>

namespace sdm::io {

class GltfDocument;

/// The elements of an accessor, sparse or not, as rows of numbers: a VEC3 is a row of three, a MAT4 one of
/// sixteen, by columns. They are read where the buffers store them and take no memory, whatever number of
/// rows the accessor declares. Normalized integers are divided by the largest value of their type. The
/// document must outlive the object.
class GltfRows {
 public:
  /// All sizes and offsets are checked against the data. Throws sdm::Error for faults.
  GltfRows(const GltfDocument& document, std::size_t accessor);

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] double number(std::size_t row, std::size_t column = 0) const;
  /// Only if there are three columns.
  [[nodiscard]] Vec3 vec3(std::size_t row) const { return {number(row, 0), number(row, 1), number(row, 2)}; }

  /// The rows that are stored; all others are zero. They increase.
  [[nodiscard]] std::size_t stored_rows() const { return base_.first ? rows_ : sparse_rows_; }
  [[nodiscard]] std::size_t stored_row(std::size_t i) const { return base_.first ? i : sparse_row(i); }

 private:
  /// Numbers in a buffer view.
  struct Block {
    const char* first = nullptr;
    std::size_t stride = 0, component_bytes = 0;
    double (*load)(const char*) = nullptr;

    [[nodiscard]] double number(std::size_t row, std::size_t column) const {
      return load(first + row * stride + column * component_bytes);
    }
  };

  [[nodiscard]] static Block block(const GltfDocument& document, const nlohmann::json& place,
                                   std::size_t component_type, bool normalized, std::size_t rows,
                                   std::size_t columns);
  /// The row that a sparse value replaces.
  [[nodiscard]] std::size_t sparse_row(std::size_t i) const {
    return static_cast<std::size_t>(indices_.number(i, 0));
  }

  std::size_t rows_ = 0, columns_ = 0, sparse_rows_ = 0;
  Block base_, indices_, values_;  // base_ without data: zeros
};

}  // namespace sdm::io
