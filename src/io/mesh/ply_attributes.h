// Which properties of a PLY element are attributes.
#pragma once

#include <vector>

#include "io/mesh/ply_header.h"
#include "io/mesh/polygons/polygon_attributes.h"

namespace sdm::io {

/// Collects the attributes of an element, row by row.
class PlyAttributes {
 public:
  PlyAttributes() = default;
  /// All numbers of the element but lists and those of `others`: nx, ny and nz as `normal`; red, green, blue
  /// and alpha, or diffuse_red and so on, as `color`; each other property by itself.
  PlyAttributes(const PlyHeader::Element& element, PolygonDomain domain, std::vector<std::size_t> others);

  /// `row`: the numbers of the element's properties.
  void add(const std::vector<double>& row);

  [[nodiscard]] std::vector<PolygonAttribute> take();

 private:
  struct Column {
    std::vector<std::size_t> places;  ///< of the properties
    double most = 0;                  ///< of a colour: the integer of full intensity; 1 for other numbers
    PolygonAttribute attribute;
  };

  bool add_group(const PlyHeader::Element& element, const char* name, PolygonDomain domain,
                 std::initializer_list<std::string_view> properties, std::vector<std::size_t>& others);

  std::vector<Column> columns_;
};

/// Adds `more` to `attributes`; those whose name is taken get the prefix `face_`.
void add_face_attributes(std::vector<PolygonAttribute>& attributes, std::vector<PolygonAttribute> more);

}  // namespace sdm::io
