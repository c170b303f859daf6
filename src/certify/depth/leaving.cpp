#include "certify/depth/leaving.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "bodies/shape/wall_column.h"
#include "geometry/boxes.h"
#include "geometry/vec.h"
#include "sites/sites_data.h"

namespace sdm::depth {
namespace {

constexpr std::uint64_t kFaceStep = std::uint64_t{1} << 32;  // between the places of faces
// Walls are thin if they are at most so many times as thick as the depth that is enough, and that depth is at
// most this fraction of the size of the solid.
constexpr double kThin = 3, kThinOfSize = 1.0 / 100;
constexpr std::size_t kSampledFaces = 16;

// Sets where a triangle is measured.
void measure_at(SurfacePart& part, TrianglePart& triangle, const CornerValues& weights) {
  const auto& [a, b, c] = triangle.at;
  triangle.weights = weights;
  part.ball = {weights[0] * a + weights[1] * b + weights[2] * c, 0};
  for (const Vec3& corner : triangle.at)
    part.ball.radius = std::max(part.ball.radius, norm(corner - part.ball.centre));
}

}  // namespace

void Leaving::start(const shape::PosedBody& body, const shape::PosedBody& solid,
                    const mesh::Similarity& to_solid) {
  body_ = &body.body();
  solid_ = &solid.body();
  to_solid_ = to_solid;
  scale_ = solid.pose().scale;
  exits_.start(internals(body_->sites()), internals(solid_->sites()), to_solid);
  known_.clear();
  thin_ = false;
  convex_ = solid_->is_small_and_convex();
}

std::array<CornerValues, 2> Leaving::bounds_by(const Corners& at,
                                               const std::array<BoundaryPart, 2>& boundary) const {
  const sites::SitesData& sites = internals(solid_->sites());
  std::array<CornerValues, 2> result;
  for (std::size_t i = 0; i < 2; ++i)
    if (!convex_ || !heights_below_plane(sites, at, boundary[i], result[i]))
      return corner_distances(sites, at, boundary);
  return result;
}

bool Leaving::tighten(SurfacePart& part, double enough) {
  const std::size_t exits = exits_.size();
  auto* triangle = std::get_if<TrianglePart>(&part.what);
  if (triangle == nullptr) {
    if (part.exits == exits) return false;
    part.limit(scale_ * exits_.bound(part.ball, part.exits));
    part.exits = exits;
    return true;
  }
  if (part.exits == exits && triangle->known == known_.size() && !triangle->stale) return false;
  const auto known = known_.nearest(part.ball.centre, triangle->bounds.all(), triangle->known);
  if (known || part.exits < exits || triangle->stale) {
    functions_.clear();
    exits_.values(triangle->at, functions_);
    for (const CornerBound& n : triangle->bounds.all()) functions_.push_back(n.distance);
    if (known)
      for (const CornerValues& d : bounds_by(triangle->at, *known)) functions_.push_back(d);
    const search::MixedBound mixed = search::mixed_bound(functions_, enough / scale_);
    part.limit(scale_ * mixed.value);
    triangle->max_distance = mixed.value;
    if (part.upper > enough) measure_at(part, *triangle, mixed.weights);
  }
  part.exits = exits;
  triangle->known = known_.size();
  triangle->stale = false;
  return true;
}

void Leaving::evaluate(SurfacePart& part, Value& value, const ClosestPoint& closest, bool inside,
                       double enough) const {
  const auto& [centre, radius] = part.ball;
  auto* triangle = std::get_if<TrianglePart>(&part.what);
  const auto keep = [&](const BoundaryPart& boundary) {
    value.bounds.add(
        {boundary, triangle != nullptr ? bounds_by(triangle->at, {boundary, boundary})[0] : CornerValues{}});
  };
  if (triangle != nullptr) ++triangle->measured;
  if (inside) {
    value.b = boundary_distance(*solid_, centre, closest);
    part.limit(scale_ * (value.b.upper + radius));
    if (triangle != nullptr) triangle->gap = scale_ * (value.b.upper - value.b.lower);
    if (value.b.nearest) keep(*value.b.nearest);
    if (thin_ && part.upper > enough) bound_by_walls(part, closest, value.b, true, enough);
    return;
  }
  Vec3 step{};
  // A point on the surface counts as outside, also where that is inside another shell. What holds of a point
  // beside it holds of the part after the same step.
  if (closest.distance == 0 && !boundary_face(*solid_, closest)) {
    const auto [beside, in] = solid_->inside().beside(centre);
    step = beside - centre;
    if (in) return evaluate_beside(part, value, step);
  }
  part.limit(scale_ * (radius + norm(step) - closest.distance));
  if (part.upper <= enough) return;
  if (thin_ && step == Vec3{}) bound_by_walls(part, closest, value.b, false, enough);
  if (triangle == nullptr || part.upper <= enough) return;
  if (const std::optional<BoundaryPart> face = boundary_face(*solid_, closest)) keep(*face);
  keep({.point = centre + step, .clear = closest.distance});
  part.limit(scale_ * bound_outside(part, *triangle, value, closest.distance, step, enough));
}

// Bounds a part whose centre is on the surface, and inside after the step.
void Leaving::evaluate_beside(SurfacePart& part, Value& value, const Vec3& step) const {
  const auto& [centre, radius] = part.ball;
  BoundaryDistance b = distance_to_boundary(*solid_, centre + step);
  b.lower = std::max(0.0, b.lower - norm(step));
  b.upper += norm(step);
  b.value = b.point ? norm(*b.point - centre) : b.lower;
  part.limit(scale_ * (b.upper + radius));
  if (auto* triangle = std::get_if<TrianglePart>(&part.what)) {
    triangle->gap = scale_ * (b.upper - b.lower);
    if (b.nearest) value.bounds.add({*b.nearest, bounds_by(triangle->at, {*b.nearest, *b.nearest})[0]});
  }
  value.b = b;
}

// Whether no point p in a ball is deeper than `enough`, if its centre c is not. If one were, some point
// between c and p were that deep, as b is continuous, and closest to a face that is not farther from c than
// the radius and that depth.
bool Leaving::walls_are_thin(const shape::Ball& ball, double enough) const {
  return solid_->wall_thickness().is_within({ball.centre, ball.radius + enough}, enough);
}

void Leaving::look_at_walls(double enough) {
  thin_ = walls_within(enough, kThin);
}

// Whether no point is deeper than so many times this depth below half of some faces.
bool Leaving::walls_within(double enough, double times) const {
  const double depth = enough / scale_;
  const std::size_t faces = internals(solid_->sites()).mesh.triangles.size();
  if (depth > kThinOfSize * diagonal(solid_->box())) return false;
  std::size_t thin = 0;
  for (std::size_t i = 0; i < kSampledFaces; ++i)
    thin += solid_->wall_thickness().of_face(static_cast<std::uint32_t>(i * faces / kSampledFaces)) <=
            times * depth;
  return 2 * thin >= kSampledFaces;
}

void Leaving::bound_by_walls(SurfacePart& part, const ClosestPoint& closest, const BoundaryDistance& b,
                             bool inside, double enough) const {
  if (scale_ * b.upper <= enough && walls_are_thin(part.ball, enough / scale_)) return part.limit(enough);
  const auto* triangle = std::get_if<TrianglePart>(&part.what);
  if (triangle == nullptr || scale_ * part.ball.radius < enough) return;
  const sites::SitesData& sites = internals(solid_->sites());
  const std::uint32_t face = sites.face_of(closest.type, closest.site);
  const Vec3 along =
      sites.sliver[face] == 0 ? sites.normals.face[face] : normalized(part.ball.centre - closest.point);
  if (along == Vec3{}) return;
  std::optional<int> winding;
  const inside::Sides sides = solid_->inside().sides().of_site(closest.type, closest.site);
  if (!inside || sides == inside::Sides::boundary || sides == inside::Sides::reversed)
    winding = !inside ? 0 : sides == inside::Sides::boundary ? 1 : -1;
  const auto column = shape::WallColumn::around(triangle->at, part.ball.centre, along);
  part.limit(scale_ * shape::bound_in_column(sites, solid_->inside(), column, winding, enough / scale_));
}

// The bound of a triangle whose centre is outside, by this distance or after this step, where that alone is
// not enough.
double Leaving::bound_outside(const SurfacePart& part, const TrianglePart& triangle, const Value& value,
                              double distance, const Vec3& step, double enough) const {
  std::array<CornerValues, 8> functions;
  std::size_t count = 0;
  for (const CornerBound& n : triangle.bounds.all()) functions[count++] = n.distance;
  for (const CornerBound& n : value.bounds.all()) functions[count++] = n.distance;
  const double mixed = search::mixed_bound(std::span(functions).first(count), enough / scale_).value;
  if (mixed <= enough / scale_) return mixed;
  // The way to a point inside is at least as long outside as the surface is far from the centre.
  const auto& [a, b, c] = triangle.at;
  return norm(step) + bound_beyond_faces(*solid_, {a + step, b + step, c + step},
                                         {part.ball.centre + step, part.ball.radius}, distance,
                                         std::min(mixed, part.ball.radius - distance));
}

void Leaving::divide(const SurfacePart& part, Parts& parts) const {
  if (const auto* triangle = std::get_if<TrianglePart>(&part.what))
    return put_quarters(part, *triangle, parts);
  const std::uint32_t node = std::get<NodePart>(part.what).node;
  if (tree::WideTree::is_leaf(node))
    put_faces(part, tree::WideTree::leaf_number(node), parts);
  else
    put_children(part, node, parts);
}

// Puts the children of a node, except those beyond the box of the solid.
void Leaving::put_children(const SurfacePart& part, std::uint32_t node, Parts& parts) const {
  const sites::SitesData& sites = internals(body_->sites());
  const tree::WideTree::Node& wide = sites.wide.nodes[node];
  const ExitDirections::OfChildren by_exits = exits_.bound_children(wide);
  for (std::uint32_t i = 0; i < wide.count; ++i) {
    SurfacePart child{
        .body = part.body, .place = wide.source[i], .upper = part.upper, .exits = exits_.size()};
    child.limit(scale_ * by_exits[i]);
    if (child.upper <= parts.enough()) {
      parts.settle(child.upper);
      continue;
    }
    child.ball = shape::ball_of_child(sites, node, i, to_solid_);
    child.what = NodePart{wide.child[i]};
    if (box_distance({child.ball.centre, child.ball.centre}, solid_->box()) <= child.ball.radius)
      parts.put(child);
  }
}

void Leaving::put_faces(const SurfacePart& part, std::uint32_t leaf, Parts& parts) const {
  const sites::SitesData& sites = internals(body_->sites());
  const Affine& map = to_solid_.map;
  for (std::uint32_t i = sites.regions.leaves[leaf]; i < sites.regions.leaves[leaf + 1]; ++i) {
    const auto& [a, b, c] = sites.mesh.triangles[sites.regions.owners[i].face];
    const auto& at = sites.mesh.positions;
    put_triangle(part, i * kFaceStep, {.at = {map(at[a]), map(at[b]), map(at[c])}, .step = kFaceStep}, parts);
  }
}

void Leaving::put_quarters(const SurfacePart& part, const TrianglePart& triangle, Parts& parts) const {
  const Corners& at = triangle.at;
  Corners middle;  // of each side
  for (int k = 0; k < 3; ++k) middle[k] = 0.5 * (at[k] + at[(k + 1) % 3]);
  std::array<TrianglePart, 4> quarters;
  for (int k = 0; k < 3; ++k) quarters[k].at = {at[k], middle[k], middle[(k + 2) % 3]};
  quarters[3].at = middle;
  for (const CornerBound& n : triangle.bounds.all()) {
    const CornerValues m = bounds_by(middle, {n.boundary, n.boundary})[0];
    for (int k = 0; k < 3; ++k) quarters[k].bounds.add({n.boundary, {n.distance[k], m[k], m[(k + 2) % 3]}});
    quarters[3].bounds.add({n.boundary, m});
  }
  // The quarters of a triangle follow it, up to the precision of the number.
  for (std::uint64_t k = 0; k < 4; ++k) {
    quarters[k].step = triangle.step / 4;
    put_triangle(part, part.place + k * quarters[k].step, quarters[k], parts);
  }
}

void Leaving::put_triangle(const SurfacePart& parent, std::uint64_t place, const TrianglePart& triangle,
                           Parts& parts) const {
  const double upper = std::min(parent.upper, scale_ * exits_.bound(triangle.at));
  if (upper <= parts.enough()) return parts.settle(upper);
  SurfacePart part{.body = parent.body, .place = place, .upper = upper, .what = triangle};
  measure_at(part, std::get<TrianglePart>(part.what), {1.0 / 3, 1.0 / 3, 1.0 / 3});
  parts.put(part);
}

}  // namespace sdm::depth
