#include "io/mesh/ply_attributes.h"

#include <sdm/mesh_attributes.h>

#include <algorithm>
#include <string>
#include <utility>

namespace sdm::io {
namespace {

// The integer that stands for full intensity; 1 for numbers that are fractions.
double full_intensity(NumberType type) {
  switch (type) {
    case NumberType::uint8:
    case NumberType::int8:
      return 255;
    case NumberType::uint16:
    case NumberType::int16:
      return 65535;
    case NumberType::float32:
    case NumberType::float64:
      return 1;
    default:
      return 255;  // whole numbers of more bytes than they need
  }
}

}  // namespace

PlyAttributes::PlyAttributes(const PlyHeader::Element& element, PolygonDomain domain,
                             std::vector<std::size_t> others) {
  add_group(element, "normal", domain, {"nx", "ny", "nz"}, others);
  for (const std::string prefix : {"", "diffuse_"}) {
    const std::string red = prefix + "red", green = prefix + "green", blue = prefix + "blue",
                      alpha = prefix + "alpha";
    if (add_group(element, "color", domain, {red, green, blue, alpha}, others) ||
        add_group(element, "color", domain, {red, green, blue}, others))
      break;
  }
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    if (element.properties[p].count_type || std::ranges::count(others, p) > 0) continue;
    columns_.push_back({.places = {p},
                        .attribute = {.name = element.properties[p].name,
                                      .components = 1,
                                      .domain = domain,
                                      .values = {},
                                      .rows = {}}});
  }
}

bool PlyAttributes::add_group(const PlyHeader::Element& element, const char* name, PolygonDomain domain,
                              std::initializer_list<std::string_view> properties,
                              std::vector<std::size_t>& others) {
  Column column;
  column.attribute.name = name;
  column.attribute.components = properties.size();
  column.attribute.domain = domain;
  for (const std::string_view property : properties) {
    const auto place = element.find({property});
    if (!place || element.properties[*place].count_type || std::ranges::count(others, *place) > 0)
      return false;
    column.places.push_back(*place);
  }
  if (column.attribute.name == "color")
    column.most = full_intensity(element.properties[column.places[0]].type);
  others.insert(others.end(), column.places.begin(), column.places.end());
  columns_.push_back(std::move(column));
  return true;
}

void PlyAttributes::add(const std::vector<double>& row) {
  for (Column& column : columns_)
    for (std::size_t k = 0; k < column.places.size(); ++k) {
      const double number = row[column.places[k]];
      const bool is_light = column.most > 0 && k < 3;  // alpha is linear
      const auto value = static_cast<float>(column.most > 0 ? number / column.most : number);
      column.attribute.values.push_back(is_light ? linear_light(value) : value);
    }
}

std::vector<PolygonAttribute> PlyAttributes::take() {
  std::vector<PolygonAttribute> attributes;
  for (Column& column : columns_) attributes.push_back(std::move(column.attribute));
  columns_.clear();
  return attributes;
}

void add_face_attributes(std::vector<PolygonAttribute>& attributes, std::vector<PolygonAttribute> more) {
  for (PolygonAttribute& attribute : more) {
    if (std::ranges::count(attributes, attribute.name, &PolygonAttribute::name) > 0)
      attribute.name.insert(0, "face_");
    attributes.push_back(std::move(attribute));
  }
}

}  // namespace sdm::io
