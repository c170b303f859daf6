// The numbers that a file has besides positions and texture coordinates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace sdm::io {

/// What an array of a file has a row for.
enum class PolygonDomain : std::uint8_t { vertex, polygon, corner };

/// An array of a file; unchecked.
struct PolygonAttribute {
  std::string name;
  std::size_t components = 1;
  PolygonDomain domain = PolygonDomain::vertex;
  std::vector<float> values;        ///< row after row
  std::vector<std::uint32_t> rows;  ///< corner: the row of each corner, or kNone

  [[nodiscard]] std::size_t count() const { return values.size() / components; }
};

}  // namespace sdm::io
