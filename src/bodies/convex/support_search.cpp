#include "bodies/convex/support_search.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bodies/convex/support_search.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bodies/convex/simplex_point.h"
#include "geometry/rounding.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::convex::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

// The vertex that is farthest along u, in single precision, of the first `size`.
HWY_INLINE std::uint32_t highest(const std::array<std::vector<float>, 3>& along, std::size_t size,
                                 const Vec3& u) {
  const hn::CappedTag<float, ConvexMesh::kBlock> d;
  const hn::RebindToSigned<decltype(d)> di;
  const std::size_t lanes = hn::Lanes(d), count = (size + lanes - 1) / lanes * lanes;
  const float *x = along[0].data(), *y = along[1].data(), *z = along[2].data();
  const auto ux = hn::Set(d, static_cast<float>(u[0])), uy = hn::Set(d, static_cast<float>(u[1])),
             uz = hn::Set(d, static_cast<float>(u[2]));
  auto best = hn::Set(d, -std::numeric_limits<float>::infinity());
  auto at = hn::Iota(di, 0), best_at = at;
  const auto step = hn::Set(di, static_cast<int>(lanes));
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto height = hn::MulAdd(hn::LoadU(d, z + i), uz,
                                   hn::MulAdd(hn::LoadU(d, y + i), uy, hn::Mul(hn::LoadU(d, x + i), ux)));
    const auto higher = hn::Gt(height, best);
    best = hn::IfThenElse(higher, height, best);
    best_at = hn::IfThenElse(hn::RebindMask(di, higher), at, best_at);
    at = hn::Add(at, step);
  }
  const intptr_t first = hn::FindFirstTrue(d, hn::Eq(best, hn::MaxOfLanes(d, best)));
  auto lane = static_cast<std::uint32_t>(first < 0 ? 0 : first);
  if (lanes < count) {
    alignas(64) std::int32_t found[ConvexMesh::kBlock];
    hn::Store(best_at, di, found);
    lane = static_cast<std::uint32_t>(found[lane]);
  }
  return std::min(lane, static_cast<std::uint32_t>(size - 1));
}

// Hill climbing: from a vertex to a neighbour that is higher by more than `least`, until there is none.
HWY_INLINE std::uint32_t climb(const ConvexMesh& mesh, const Vec3& u, std::uint32_t vertex, double least) {
  for (;;) {
    const Vec3& from = mesh.points[vertex];
    std::uint32_t next = vertex;
    double most = least;
    for (const Spoke& spoke : mesh.spokes.of(vertex))
      if (const double higher = dot(u, mesh.points[spoke.end] - from); higher > most) {
        most = higher;
        next = spoke.end;
      }
    if (next == vertex) return vertex;
    vertex = next;
  }
}

// A vertex that is farthest along u, up to the height error.
HWY_INLINE std::uint32_t nearly_farthest_vertex(const ConvexMesh& mesh, const Vec3& u) {
  if (mesh.coarse_vertex.empty()) return highest(mesh.along, mesh.points.size(), u);
  const std::uint32_t nearest = highest(mesh.coarse, mesh.coarse_vertex.size(), u);
  return climb(mesh, u, mesh.coarse_vertex[nearest], mesh.least_climb);
}

class SupportSearch {
 public:
  SupportSearch(const SupportRequest& request, Simplex& simplex) : r_(request), known_(simplex) {
    const double inverse_scale = 1 / r_.scale;
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) turn_[j][k] = inverse_scale * r_.pose.rows[k][j];
    error_ = r_.o1.height_error + r_.scale * r_.o2.height_error + 4 * r_.rounding;
    size_ = r_.o1.size + r_.scale * r_.o2.size;
  }

  Relation run() {
    if (begin()) return Relation::overlap;
    constexpr int kMostSteps = 40;
    for (int step = 0; step < kMostSteps; ++step) {
      const double squared = squared_norm(v_);
      if (!(squared > 1e-24 * size_ * size_)) return keep_touching();
      const double length = std::sqrt(squared);
      const SimplexPoint p = support((-1 / length) * v_);
      const double along = dot(p.w, v_) / length;  // no point of the difference is nearer to the origin
      if (along - error_ > r_.beyond) return keep(Relation::apart);
      if (known(p) || along > length - kConverged * length - kNoise * size_) return keep(Relation::near);
      simplex_.add(p);
      if (!simplex_.reduce(v_)) return encloses_origin() ? keep(Relation::overlap) : keep_nearest_face();
    }
    return keep(Relation::unknown);
  }

 private:
  static constexpr double kConverged = 1e-13, kNoise = 1e-15;

  SimplexPoint point_of(std::uint32_t v1, std::uint32_t v2) const {
    return {{v1, v2}, r_.o1.points[v1] - r_.pose(r_.o2.points[v2])};
  }
  SimplexPoint support(const Vec3& u) {
    constexpr double kNear = 0.97;  // cosine
    climb_ = simplex_.count > 0 && dot(u, last_u_) > kNear;
    last_u_ = u;
    const Vec3 u2{-dot(turn_[0], u), -dot(turn_[1], u), -dot(turn_[2], u)};
    return point_of(farthest(r_.o1, u, 0), farthest(r_.o2, u2, 1));
  }
  // The last vertex is near the next one in a similar direction.
  std::uint32_t farthest(const ConvexMesh& mesh, const Vec3& u, int side) const {
    if (!mesh.climbs || !climb_) return nearly_farthest_vertex(mesh, u);
    return climb(mesh, u, simplex_.points[simplex_.count - 1].vertices[side], mesh.least_climb);
  }

  // The simplex of a similar pose is a better start than the centres, unless the poses differ much. Returns
  // whether it still encloses the origin.
  bool begin() {
    const Vec3 between = r_.o1.centre - r_.pose(r_.o2.centre);
    if (known_.count > 0 && (known_.count == 4 || similar(known_.away, between)) && take_known()) {
      if (simplex_.count == 4 && encloses_origin()) return true;
      if (simplex_.reduce(v_) && similar(v_, between)) {
        last_u_ = (-1 / norm(v_)) * v_;
        return false;
      }
    }
    simplex_.count = 0;
    v_ = between;
    if (!(squared_norm(v_) > 1e-20 * size_ * size_)) v_ = {size_, 0, 0};
    const double length = norm(v_);
    simplex_.add(support((-1 / length) * v_));
    v_ = simplex_.points[0].w;
    return false;
  }

  static bool similar(const Vec3& a, const Vec3& b) {
    constexpr double kSimilar = 0.6;  // cosine
    const double along = dot(a, b);
    return along > 0 && along * along > kSimilar * kSimilar * squared_norm(a) * squared_norm(b);
  }
  bool take_known() {
    for (std::uint32_t i = 0; i < known_.count; ++i) {
      const auto& [v1, v2] = known_.vertices[i];
      if (v1 >= r_.o1.points.size() || v2 >= r_.o2.points.size()) return false;
      simplex_.add(point_of(v1, v2));
    }
    return true;
  }

  bool known(const SimplexPoint& p) const {
    for (int i = 0; i < simplex_.count; ++i)
      if (simplex_.points[i].vertices == p.vertices) return true;
    return false;
  }
  bool encloses_origin() const {
    return simplex_.count == 4 && simplex_.depth_of_origin() > 16 * r_.rounding + 1e-13 * size_;
  }
  Relation keep(Relation relation) {
    known_.count = static_cast<std::uint32_t>(simplex_.count);
    known_.away = normalized(v_);
    for (int i = 0; i < simplex_.count; ++i) known_.vertices[i] = simplex_.points[i].vertices;
    return relation;
  }

  // The simplex has four points about the origin, which is within rounding of a face.
  Relation keep_nearest_face() {
    v_ = -simplex_.keep_nearest_face();
    return keep(Relation::unknown);
  }
  // Where the closest points are one, they have no direction between them: the last one was.
  Relation keep_touching() {
    v_ = -last_u_;
    return keep(Relation::unknown);
  }

  const SupportRequest& r_;
  Simplex& known_;
  std::array<Vec3, 3> turn_;  // from the frame of O1 to that of O2, without the scale
  double error_, size_;
  SimplexPoints simplex_;
  Vec3 last_u_{};
  bool climb_ = false;
  Vec3 v_{};  // the point of the simplex that is closest to the origin
};

}  // namespace

std::uint32_t FarthestVertex(const ConvexMesh& mesh, const Vec3& u, std::uint32_t near) {
  if (mesh.climbs)
    return climb(mesh, u, near != kNone ? near : nearly_farthest_vertex(mesh, u), kFewRoundings * mesh.size);
  std::uint32_t farthest = 0;
  double most = -kInfinity;
  for (std::uint32_t v = 0; v < mesh.points.size(); ++v)
    if (const double along = dot(u, mesh.points[v]); along > most) {
      most = along;
      farthest = v;
    }
  return farthest;
}

Relation SearchBySupports(const SupportRequest& request, Simplex& simplex) {
  return SupportSearch(request, simplex).run();
}

}  // namespace sdm::convex::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::convex {

HWY_EXPORT(FarthestVertex);
HWY_EXPORT(SearchBySupports);

std::uint32_t farthest_vertex(const ConvexMesh& mesh, const Vec3& u, std::uint32_t near) {
  return HWY_DYNAMIC_DISPATCH(FarthestVertex)(mesh, u, near);
}

Relation search_by_supports(const SupportRequest& request, Simplex& simplex) {
  return HWY_DYNAMIC_DISPATCH(SearchBySupports)(request, simplex);
}

}  // namespace sdm::convex
#endif
