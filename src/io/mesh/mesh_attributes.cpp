#include "io/mesh/mesh_attributes.h"

#include <memory>
#include <utility>

namespace sdm::io {
namespace {

using Rows = std::vector<Triangle>;

bool fits(const PolygonAttribute& attribute, const PolygonMesh& polygons) {
  switch (attribute.domain) {
    case PolygonDomain::vertex:
      return attribute.count() == polygons.positions.size();
    case PolygonDomain::polygon:
      return attribute.count() == polygons.ends.size();
    case PolygonDomain::corner:
      return attribute.rows.size() == polygons.corners.size();
  }
  return false;
}

std::shared_ptr<const Rows> rows_of_corners(const std::vector<Triangle>& places,
                                            const std::vector<std::uint32_t>& row_of) {
  auto rows = std::make_shared<Rows>(places.size());
  for (std::size_t f = 0; f < places.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) (*rows)[f][k] = row_of[places[f][k]];
  return rows;
}

// Texture coordinates that some corners lack, which Mesh::corner_uvs cannot hold.
MeshAttribute partial_uvs(const PolygonMesh& polygons, const std::vector<Triangle>& places) {
  std::vector<float> values;
  values.reserve(2 * polygons.uvs.size());
  for (const Vec2& uv : polygons.uvs)
    for (const double x : uv) values.push_back(static_cast<float>(x));
  std::vector<std::uint32_t> row_of = polygons.corner_uvs;
  for (std::uint32_t& row : row_of)
    if (row >= polygons.uvs.size()) row = kNone;
  return {
      .name = "uv0", .components = 2, .values = std::move(values), .rows = rows_of_corners(places, row_of)};
}

std::shared_ptr<const Rows> rows_of_polygons(const std::vector<std::uint32_t>& triangle_ends) {
  auto rows = std::make_shared<Rows>();
  for (std::uint32_t polygon = 0; polygon < triangle_ends.size(); ++polygon)
    rows->resize(triangle_ends[polygon], {polygon, polygon, polygon});
  return rows;
}

}  // namespace

std::vector<MeshAttribute> to_attributes(PolygonMesh& polygons, const std::vector<Triangle>& places,
                                         const std::vector<std::uint32_t>& triangle_ends,
                                         std::vector<std::string>& notes) {
  std::shared_ptr<const Rows> of_vertices, of_polygons;
  std::vector<MeshAttribute> result;
  if (!uv_fault(polygons).empty()) result.push_back(partial_uvs(polygons, places));
  for (PolygonAttribute& attribute : polygons.attributes) {
    if (!fits(attribute, polygons)) {
      notes.push_back("the attribute `" + attribute.name + "` is left out: some faces have none");
      continue;
    }
    std::shared_ptr<const Rows> rows;
    switch (attribute.domain) {
      case PolygonDomain::vertex:
        if (!of_vertices) of_vertices = rows_of_corners(places, polygons.corners);
        rows = of_vertices;
        break;
      case PolygonDomain::polygon:
        if (!of_polygons) of_polygons = rows_of_polygons(triangle_ends);
        rows = of_polygons;
        break;
      case PolygonDomain::corner:
        rows = rows_of_corners(places, attribute.rows);
    }
    result.push_back({.name = std::move(attribute.name),
                      .components = attribute.components,
                      .values = std::move(attribute.values),
                      .rows = std::move(rows)});
  }
  return result;
}

std::vector<std::uint32_t> materials_of_triangles(const PolygonMaterials& materials,
                                                  const std::vector<std::uint32_t>& triangle_ends) {
  std::vector<std::uint32_t> of_triangles;
  std::uint32_t material = kNone;
  auto run = materials.runs.begin();
  for (std::uint32_t polygon = 0; polygon < triangle_ends.size(); ++polygon) {
    for (; run != materials.runs.end() && run->first_polygon <= polygon; ++run) material = run->material;
    of_triangles.resize(triangle_ends[polygon], material);
  }
  return of_triangles;
}

}  // namespace sdm::io
