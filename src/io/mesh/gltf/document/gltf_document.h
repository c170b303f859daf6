// The JSON and the buffers of a glTF file.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh/gltf/document/gltf_buffers.h"

namespace sdm::io {

/// Returns a member that is an index, a count or a size. Throws sdm::Error if it is not a non-negative
/// integer.
[[nodiscard]] std::size_t whole_number(const nlohmann::json& object, const char* name);
[[nodiscard]] std::size_t whole_number(const nlohmann::json& object, const char* name, std::size_t otherwise);
/// Returns a member that is a list of such numbers; empty if there is no such member.
[[nodiscard]] std::vector<std::size_t> whole_numbers(const nlohmann::json& object, const char* name);
/// Returns a member that is a list; an empty one if there is no such member.
[[nodiscard]] const nlohmann::json& list_of(const nlohmann::json& object, const char* name);

/// Returns a value that is text. Throws sdm::Error, with its name, if it is not.
[[nodiscard]] const std::string& text_of(const nlohmann::json& value, const char* name);

/// Rethrows a fault about a missing member, or one of the wrong type, as sdm::Error.
[[noreturn]] void throw_gltf_fault(const nlohmann::json::exception& fault);

/// Throws sdm::Error for faults; nlohmann::json::exception for members that are missing or of the wrong type.
class GltfDocument {
 public:
  /// Parses JSON or GLB and loads the buffers; external buffers are looked up in `folder`. `bytes` must
  /// outlive the document.
  GltfDocument(std::string_view bytes, const std::filesystem::path& folder);

  [[nodiscard]] const nlohmann::json& root() const { return root_; }
  [[nodiscard]] const GltfBuffers& buffers() const { return buffers_; }
  /// Returns an item of a top-level list. Throws if it does not exist.
  [[nodiscard]] const nlohmann::json& item(const char* list, std::size_t index) const;
  /// Returns the number of rows that an accessor declares.
  [[nodiscard]] std::size_t count(std::size_t accessor) const {
    return whole_number(item("accessors", accessor), "count");
  }
  /// Returns the bytes of a buffer view. Throws if it extends beyond its buffer, or is compressed.
  [[nodiscard]] std::string_view view(std::size_t index) const;
  /// Returns the numbers of an accessor, row by row. Their memory is charged.
  [[nodiscard]] std::vector<double> numbers(std::size_t accessor) const;

  /// Charges memory to the budget of the document before it is allocated: 64 MiB and 4096 times the size of
  /// its files, because a few bytes may declare, or refer to, any number of vertices. Throws sdm::Error,
  /// naming `purpose`, if that or the memory of the machine is exceeded.
  void charge(std::size_t bytes, std::string_view purpose) const;

 private:
  nlohmann::json root_;
  GltfBuffers buffers_;
  std::size_t file_bytes_ = 0;
  mutable std::size_t charged_ = 0, checked_ = 0;  // checked_: of it, also against the memory of the machine
};

}  // namespace sdm::io
