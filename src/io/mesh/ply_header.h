// The header of a PLY file, which declares elements and their properties.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/file/number_type.h"

namespace sdm::io {

struct PlyHeader {
  enum class Encoding { text, little_endian, big_endian };
  struct Property {
    std::string name;
    NumberType type;
    std::optional<NumberType> count_type;  ///< of a list: the type of its length
  };
  struct Element {
    std::string name;
    std::size_t count;
    std::vector<Property> properties;

    /// Returns the index of the first of these properties that exists, in lower case or else in any other.
    [[nodiscard]] std::optional<std::size_t> find(std::initializer_list<std::string_view> names) const;
  };

  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
  std::size_t size = 0;  ///< in bytes; the data follow
};

/// Parses the header at the start of a file. Throws sdm::Error if it is invalid.
[[nodiscard]] PlyHeader parse_ply_header(std::string_view bytes);

}  // namespace sdm::io
