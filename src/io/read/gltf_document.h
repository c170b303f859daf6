// A glTF file taken apart: its JSON and its buffers.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "io/read/file_bytes.h"

namespace sdm::io {

/// A member that is an index, a count or a size. Throws sdm::Error where it is not a whole number.
[[nodiscard]] std::size_t whole_number(const nlohmann::json& object, const char* name);
[[nodiscard]] std::size_t whole_number(const nlohmann::json& object, const char* name, std::size_t otherwise);
/// A member that is a list of them; empty where there is none.
[[nodiscard]] std::vector<std::size_t> whole_numbers(const nlohmann::json& object, const char* name);

/// The numbers of an accessor, row by row: three a row for VEC3.
struct GltfNumbers {
  std::size_t columns = 0;
  std::vector<double> values;

  [[nodiscard]] std::size_t rows() const { return values.size() / columns; }
  [[nodiscard]] const double* row(std::size_t r) const { return values.data() + r * columns; }
};

/// Throws sdm::Error for a member that is missing or of the wrong type.
[[noreturn]] void throw_gltf_fault(const nlohmann::json::exception& fault);

/// Everything is checked against the bytes that are there. Faults throw sdm::Error, or
/// nlohmann::json::exception where a member is missing or of the wrong type.
class GltfDocument {
 public:
  /// From JSON or GLB; `folder` is where buffers outside of it are looked for.
  GltfDocument(std::string_view bytes, const std::filesystem::path& folder);

  [[nodiscard]] const nlohmann::json& root() const { return root_; }
  /// The item of a list at the top; throws where there is none.
  [[nodiscard]] const nlohmann::json& item(const char* list, std::size_t index) const;
  /// The rows that an accessor promises.
  [[nodiscard]] std::size_t count(std::size_t accessor) const {
    return whole_number(item("accessors", accessor), "count");
  }
  /// The numbers of an accessor, sparse or not; integers are divided by their largest value where it says
  /// `normalized`.
  [[nodiscard]] GltfNumbers numbers(std::size_t accessor) const;

 private:
  /// Rows that stand in a buffer view, which `place` tells with an offset.
  [[nodiscard]] std::vector<double> rows_of(const nlohmann::json& place, std::size_t component_type,
                                            bool normalized, std::size_t rows, std::size_t columns) const;
  void load_buffers(std::optional<std::string_view> binary_chunk, const std::filesystem::path& folder);

  nlohmann::json root_;
  std::vector<FileBytes> files_;  // that the buffers stand in
  std::vector<std::string_view> buffers_;
};

}  // namespace sdm::io
