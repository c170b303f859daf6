#include "support/pair_oracle.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <variant>

namespace sdm::oracle {
namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Exact::Point_3;
using Segment = Exact::Segment_3;
using Triangle3 = Exact::Triangle_3;
using Shape = std::variant<Point, Segment, Triangle3>;

// What the corners span: CGAL takes no degenerate triangles.
Shape shape_of(const Corners& t) {
  std::vector<Point> p;
  for (const Vec3& corner : t) p.emplace_back(corner[0], corner[1], corner[2]);
  if (!CGAL::collinear(p[0], p[1], p[2])) return Triangle3(p[0], p[1], p[2]);
  std::ranges::sort(p);  // along the line
  if (p[0] == p[2]) return p[0];
  return Segment(p[0], p[2]);
}

template <class A, class B>
bool meet(const A& a, const B& b) {
  return CGAL::do_intersect(a, b);
}
bool meet(const Point& a, const Point& b) {
  return a == b;
}
bool meet(const Segment& a, const Point& b) {
  return a.has_on(b);
}
bool meet(const Point& a, const Segment& b) {
  return b.has_on(a);
}

template <class A, class B>
Exact::FT squared(const A& a, const B& b) {
  return CGAL::squared_distance(a, b);
}
Exact::FT squared(const Segment& a, const Triangle3& b) {
  if (meet(a, b)) return 0;
  Exact::FT least = std::min(squared(a.source(), b), squared(a.target(), b));
  for (int k = 0; k < 3; ++k) least = std::min(least, squared(a, Segment(b.vertex(k), b.vertex(k + 1))));
  return least;
}
Exact::FT squared(const Triangle3& a, const Segment& b) {
  return squared(b, a);
}

using Inexact = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Inexact::Triangle_3>;

Inexact::Point_3 to_cgal(const Vec3& p) {
  return {p[0], p[1], p[2]};
}

}  // namespace

double distance(const Corners& a, const Corners& b) {
  const Exact::FT value =
      std::visit([](const auto& s, const auto& t) { return squared(s, t); }, shape_of(a), shape_of(b));
  return std::sqrt(CGAL::to_double(value.exact()));
}

bool intersect(const Corners& a, const Corners& b) {
  return std::visit([](const auto& s, const auto& t) { return meet(s, t); }, shape_of(a), shape_of(b));
}

struct CgalSurface::Impl {
  Triangles triangles;
  CGAL::AABB_tree<
      CGAL::AABB_traits<Inexact, CGAL::AABB_triangle_primitive<Inexact, Triangles::const_iterator>>>
      tree;
};

CgalSurface::CgalSurface(const Mesh& mesh) : impl_(new Impl) {
  for (const auto& [a, b, c] : mesh.triangles)
    impl_->triangles.emplace_back(to_cgal(mesh.positions[a]), to_cgal(mesh.positions[b]),
                                  to_cgal(mesh.positions[c]));
  impl_->tree.insert(impl_->triangles.cbegin(), impl_->triangles.cend());
  impl_->tree.build();
}
CgalSurface::~CgalSurface() = default;

bool CgalSurface::meets(const Corners& t) const {
  return impl_->tree.do_intersect(Inexact::Triangle_3(to_cgal(t[0]), to_cgal(t[1]), to_cgal(t[2])));
}

}  // namespace sdm::oracle
