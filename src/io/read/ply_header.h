// The header of a PLY file: which elements follow, and their properties.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sdm::io {

struct PlyHeader {
  enum class Encoding { text, little_endian, big_endian };
  enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
  struct Property {
    std::string name;
    Type type;
    std::optional<Type> count_type;  ///< of a list: the type of its length
  };
  struct Element {
    std::string name;
    std::size_t count;
    std::vector<Property> properties;

    /// The place of the first of these properties that is there.
    [[nodiscard]] std::optional<std::size_t> find(std::initializer_list<std::string_view> names) const;
  };

  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
  std::size_t size = 0;  ///< bytes of the header; the data follow
};

/// Bytes that a number takes in a binary file.
[[nodiscard]] std::size_t size_of(PlyHeader::Type type);

/// Throws sdm::Error for anything that is no PLY header.
[[nodiscard]] PlyHeader parse_ply_header(std::string_view bytes);

}  // namespace sdm::io
