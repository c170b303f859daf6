// The JSON and the buffers of a glTF file.
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

/// Returns a member that is an index, a count or a size. Throws sdm::Error if it is not a non-negative
/// integer.
[[nodiscard]] std::size_t whole_number(const nlohmann::json& object, const char* name);
[[nodiscard]] std::size_t whole_number(const nlohmann::json& object, const char* name, std::size_t otherwise);
/// Returns a member that is a list of such numbers; empty if there is no such member.
[[nodiscard]] std::vector<std::size_t> whole_numbers(const nlohmann::json& object, const char* name);

/// The elements of an accessor, as rows of numbers: a VEC3 is a row of three.
struct GltfNumbers {
  std::size_t columns = 0;
  std::vector<double> values;

  [[nodiscard]] std::size_t rows() const { return values.size() / columns; }
  [[nodiscard]] const double* row(std::size_t r) const { return values.data() + r * columns; }
};

/// Rethrows a fault about a missing member, or one of the wrong type, as sdm::Error.
[[noreturn]] void throw_gltf_fault(const nlohmann::json::exception& fault);

/// All sizes and offsets are checked against the data. Throws sdm::Error for faults;
/// nlohmann::json::exception for members that are missing or of the wrong type.
class GltfDocument {
 public:
  /// Parses JSON or GLB and loads the buffers; external buffers are looked up in `folder`.
  GltfDocument(std::string_view bytes, const std::filesystem::path& folder);

  [[nodiscard]] const nlohmann::json& root() const { return root_; }
  /// Returns an item of a top-level list. Throws if it does not exist.
  [[nodiscard]] const nlohmann::json& item(const char* list, std::size_t index) const;
  /// Returns the number of rows that an accessor declares.
  [[nodiscard]] std::size_t count(std::size_t accessor) const {
    return whole_number(item("accessors", accessor), "count");
  }
  /// Returns the numbers of an accessor, sparse or not. Normalized integers are divided by the largest value
  /// of their type.
  [[nodiscard]] GltfNumbers numbers(std::size_t accessor) const;

 private:
  /// Returns rows of a buffer view. `place` contains the index of the view and the offset in it.
  [[nodiscard]] std::vector<double> rows_of(const nlohmann::json& place, std::size_t component_type,
                                            bool normalized, std::size_t rows, std::size_t columns) const;
  void load_buffers(std::optional<std::string_view> binary_chunk, const std::filesystem::path& folder);

  nlohmann::json root_;
  std::vector<FileBytes> files_;  // the memory of buffers_, except for the binary chunk
  std::vector<std::string_view> buffers_;
};

}  // namespace sdm::io
