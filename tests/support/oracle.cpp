#include "support/oracle.h"

#include <CGAL/AABB_segment_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>

#include "geometry/vec.h"

namespace sdm::oracle {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

template <template <class, class, class...> class Primitive, class Item>
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<
    Kernel, Primitive<Kernel, typename std::vector<Item>::const_iterator, CGAL::Tag_false>>>;

Point to_cgal(const Vec3& p) {
  return {p[0], p[1], p[2]};
}

}  // namespace

struct CgalDistance::Impl {
  std::vector<Kernel::Triangle_3> triangles;
  std::vector<Kernel::Segment_3> segments;
  std::vector<Vec3> points;  // faces whose corners coincide
  Tree<CGAL::AABB_triangle_primitive, Kernel::Triangle_3> triangle_tree;
  Tree<CGAL::AABB_segment_primitive, Kernel::Segment_3> segment_tree;
};

CgalDistance::CgalDistance(const Mesh& mesh) : impl_(new Impl) {
  const double least_height = 1e-8 * diagonal(bounds(mesh));
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
    if (norm(cross(b - a, c - a)) > longest * least_height) {
      impl_->triangles.emplace_back(to_cgal(a), to_cgal(b), to_cgal(c));
      continue;
    }
    if (longest == 0) impl_->points.push_back(a);
    for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}})
      if (p != q) impl_->segments.emplace_back(to_cgal(p), to_cgal(q));
  }
  impl_->triangle_tree.insert(impl_->triangles.cbegin(), impl_->triangles.cend());
  impl_->segment_tree.insert(impl_->segments.cbegin(), impl_->segments.cend());
  if (!impl_->triangles.empty()) impl_->triangle_tree.accelerate_distance_queries();
  if (!impl_->segments.empty()) impl_->segment_tree.accelerate_distance_queries();
}

CgalDistance::~CgalDistance() = default;

double CgalDistance::operator()(const Vec3& point) const {
  double squared = std::numeric_limits<double>::infinity();
  const Point p = to_cgal(point);
  if (!impl_->triangles.empty()) squared = std::min(squared, impl_->triangle_tree.squared_distance(p));
  if (!impl_->segments.empty()) squared = std::min(squared, impl_->segment_tree.squared_distance(p));
  for (const Vec3& q : impl_->points) squared = std::min(squared, squared_norm(q - point));
  return std::sqrt(squared);
}

struct CgalInside::Impl {
  CGAL::Surface_mesh<Point> mesh;
  std::unique_ptr<CGAL::Side_of_triangle_mesh<CGAL::Surface_mesh<Point>, Kernel>> side;
};

CgalInside::CgalInside(const Mesh& mesh) : impl_(new Impl) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  std::vector<Point> points;
  for (const Vec3& p : mesh.positions) points.push_back(to_cgal(p));
  std::vector<std::vector<std::size_t>> polygons;
  for (const Triangle& t : mesh.triangles) polygons.push_back({t[0], t[1], t[2]});
  pmp::orient_polygon_soup(points, polygons);
  pmp::polygon_soup_to_polygon_mesh(points, polygons, impl_->mesh);
  impl_->side = std::make_unique<CGAL::Side_of_triangle_mesh<CGAL::Surface_mesh<Point>, Kernel>>(impl_->mesh);
  (void)(*impl_->side)(points.front());  // builds the tree, which threads then share
}

CgalInside::~CgalInside() = default;

bool CgalInside::operator()(const Vec3& point) const {
  return (*impl_->side)(to_cgal(point)) != CGAL::ON_UNBOUNDED_SIDE;
}

struct CgalPoints::Impl {
  using Cartesian = CGAL::Simple_cartesian<double>;
  using Search = CGAL::Orthogonal_k_neighbor_search<CGAL::Search_traits_3<Cartesian>>;
  Search::Tree tree;
};

CgalPoints::CgalPoints(const std::vector<Vec3>& points) : impl_(new Impl) {
  for (const Vec3& p : points) impl_->tree.insert({p[0], p[1], p[2]});
  impl_->tree.build<CGAL::Sequential_tag>();  // before threads share it
}

CgalPoints::~CgalPoints() = default;

double CgalPoints::distance(const Vec3& p) const {
  return std::sqrt(Impl::Search(impl_->tree, {p[0], p[1], p[2]}, 1).begin()->second);
}

namespace {

using Real = long double;
using Real3 = std::array<Real, 3>;

Real3 minus(const Vec3& a, const Vec3& b) {
  return {Real(a[0]) - b[0], Real(a[1]) - b[1], Real(a[2]) - b[2]};
}
Real dot(const Real3& a, const Real3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Real3 cross(const Real3& a, const Real3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

double distance(const Vec3& point, const Vec3& a, const Vec3& b) {
  const Real3 edge = minus(b, a), to_point = minus(point, a);
  const Real squared_length = dot(edge, edge);
  const Real t = squared_length > 0 ? std::clamp<Real>(dot(to_point, edge) / squared_length, 0, 1) : 0;
  Real squared = 0;
  for (int k = 0; k < 3; ++k) squared += (to_point[k] - t * edge[k]) * (to_point[k] - t * edge[k]);
  return static_cast<double>(std::sqrt(squared));
}

double distance(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Real3 normal = cross(minus(b, a), minus(c, a));
  const Real squared_area = dot(normal, normal);
  const auto left_of = [&](const Vec3& p, const Vec3& q) {
    return dot(cross(normal, minus(q, p)), minus(point, p)) >= 0;
  };
  if (squared_area > 0 && left_of(a, b) && left_of(b, c) && left_of(c, a))
    return static_cast<double>(std::abs(dot(minus(point, a), normal)) / std::sqrt(squared_area));
  return std::min({distance(point, a, b), distance(point, b, c), distance(point, c, a)});
}

double brute_force(const Mesh& mesh, const Vec3& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : mesh.triangles)
    least =
        std::min(least, distance(point, mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]));
  return least;
}

int winding_number(const Mesh& mesh, const Vec3& point) {
  Real sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Real3 a = minus(mesh.positions[t[0]], point), b = minus(mesh.positions[t[1]], point),
                c = minus(mesh.positions[t[2]], point);
    const Real la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
    sum +=
        2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return static_cast<int>(std::lround(sum / (4 * std::numbers::pi_v<Real>)));
}

}  // namespace sdm::oracle
