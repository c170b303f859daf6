#include "map/transfer/closest_of_texels.h"

#include <sdm/error.h>

#include <algorithm>

#include "closest/facing/facing_normals.h"
#include "geometry/triangle.h"
#include "sites/closest_on_face.h"

namespace sdm::map {
namespace {

SurfacePoint at_vertex(const Mesh& mesh, std::uint32_t face, std::uint32_t vertex) {
  SurfacePoint point{.face = face};
  const Triangle& corners = mesh.triangles[face];
  point.barycentric[std::ranges::find(corners, vertex) - corners.begin()] = 1;
  return point;
}

SurfacePoint on_edge(const Mesh& mesh, std::uint32_t face, const std::array<std::uint32_t, 2>& ends,
                     double parameter) {
  SurfacePoint point{.face = face};
  const Triangle& corners = mesh.triangles[face];
  point.barycentric[std::ranges::find(corners, ends[0]) - corners.begin()] = 1 - parameter;
  point.barycentric[std::ranges::find(corners, ends[1]) - corners.begin()] = parameter;
  return point;
}

}  // namespace

std::uint32_t face_that_faces(const sites::SitesData& data, SiteType type, std::uint32_t site,
                              const Vec3& normal) {
  if (type == SiteType::face) return site;
  const std::span<const std::uint32_t> faces =
      type == SiteType::edge ? data.topology.edge_faces(site) : data.vertex_faces.of(site);
  return *std::ranges::max_element(faces, {}, [&](std::uint32_t face) {
    return data.sliver[face] != 0 ? -2 : dot(normal, facing::outward_normal(data, face));
  });
}

ClosestOfTexels::ClosestOfTexels(const Surface& surface, const Sites& sites, const DistanceMap& map,
                                 std::span<const Vec3> normals)
    : surface_(internals(surface)),
      data_(internals(sites)),
      map_(map),
      normals_(map.measured.kind == DistanceKind::facing ? normals : std::span<const Vec3>()),
      ends_elsewhere_(ends_anywhere(map.measured.kind)) {}

SurfacePoint ClosestOfTexels::at(std::uint32_t texel) {
  const SiteType type = map_.site_type[texel];
  if (type == SiteType::none) return {};
  const std::uint32_t owner = surface_.map_faces[texel], number = map_.site[texel];
  if (texel - row_begin_ >= surface_.resolution) {
    row_ = texel / surface_.resolution;
    row_begin_ = row_ * surface_.resolution;
  }
  const Vec3 query = surface_.to_surface(owner, {texel - row_begin_ + 0.5, row_ + 0.5});
  if (ends_elsewhere_) return end_of_vector(texel, query);
  if (type != site_.type || number != site_.number) read(type, number);
  if (type == SiteType::face) return in_face(query);
  const std::uint32_t face =
      normals_.empty() ? site_.face : face_that_faces(data_, type, number, normals_[owner]);
  if (type == SiteType::vertex) return at_vertex(data_.mesh, face, site_.ends[0]);
  return on_edge(data_.mesh, face, site_.ends, std::clamp(dot(query - site_.origin, site_.along), 0.0, 1.0));
}

void ClosestOfTexels::read(SiteType type, std::uint32_t number) {
  const std::size_t count = type == SiteType::vertex ? data_.mesh.positions.size()
                            : type == SiteType::edge ? data_.topology.edges.size()
                                                     : data_.mesh.triangles.size();
  if (number >= count || (type == SiteType::vertex && data_.vertex_faces.of(number).empty()))
    throw Error("the map names a site that the other mesh does not have");
  site_.type = type;
  site_.number = number;
  site_.face = data_.face_of(type, number);
  const auto& positions = data_.mesh.positions;
  if (type == SiteType::vertex) {
    site_.ends[0] = number;
  } else if (type == SiteType::edge) {
    site_.ends = data_.topology.edges[number];
    site_.origin = positions[site_.ends[0]];
    const Vec3 side = positions[site_.ends[1]] - site_.origin;
    const double squared = squared_norm(side);
    site_.along = squared > 0 ? 1 / squared * side : Vec3{};
  } else {
    site_.frame = BarycentricFrame(corners_of(data_.mesh, number));
  }
}

SurfacePoint ClosestOfTexels::in_face(const Vec3& query) const {
  // The coordinates of a point beside the face are limited to its sides, where one is 0.
  constexpr double kBesideSides = 1e-9;
  const SurfacePoint found{site_.face, site_.frame.weights(query)};
  if (*std::ranges::min_element(found.barycentric) > kBesideSides) return found;
  return {site_.face, site_.frame.weights(sites::closest_on_face(data_, site_.face, query).point)};
}

SurfacePoint ClosestOfTexels::end_of_vector(std::uint32_t texel, const Vec3& point) const {
  const std::uint32_t face = map_.site[texel];
  if (face >= data_.mesh.triangles.size())
    throw Error("the map names a site that the other mesh does not have");
  Vec3 end = point;
  for (int i = 0; i < 3; ++i) end[i] += map_.vector[texel][i];
  return {face, BarycentricFrame(corners_of(data_.mesh, face)).weights(end)};
}

}  // namespace sdm::map
