#include "bodies/solids/convex_patch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bodies/convex/convex_mesh.h"
#include "geometry/unit_across.h"
#include "geometry/vec.h"

namespace sdm::solids {
namespace {

constexpr double kNear = 1e-6;  // of the size

// Ids: what a contact of a patch is of, in bits that no id of contacts() has together.
constexpr std::uint64_t kOfPatch = std::uint64_t{1} << 62, kCrossing = std::uint64_t{1} << 61;
constexpr int kBodyShift = 63, kVertexBits = 14;
static_assert(convex::kMostVertices + 2 < 1 << kVertexBits);

double squared_distance(const Vec2& a, const Vec2& b) {
  return dot(b - a, b - a);
}

double squared_distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 side = b - a;
  const double length = dot(side, side);
  const double t = length > 0 ? std::clamp(dot(p - a, side) / length, 0.0, 1.0) : 0;
  return squared_distance(p, a + t * side);
}

ContactPlane plane_across(const Vec3& normal, const Vec3& origin, double size) {
  const Vec3 first = unit_across(normal);
  return {origin, {first, cross(normal, first)}, size};
}

// The corner of a feature at a point of the plane; the number of corners if there is none.
std::size_t corner_at(const SupportFeature& feature, const Vec2& at, double near) {
  const auto found = std::ranges::find_if(feature.corners(), [&](const SupportFeature::Corner& corner) {
    return squared_distance(corner.at, at) <= near * near;
  });
  return static_cast<std::size_t>(found - feature.corners().begin());
}

// Both ends of the side of a feature that is nearest to a point, as numbers in its ConvexMesh.
std::uint64_t side_at(const SupportFeature& feature, const Vec2& at) {
  const std::span<const SupportFeature::Corner> corners = feature.corners();
  double least = kInfinity;
  std::array<std::uint32_t, 2> ends{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double squared = squared_distance(at, a.at, b.at);
    if (!(squared < least)) continue;
    least = squared;
    ends = {a.vertex, b.vertex};
  }
  std::uint64_t result = 0;
  for (const std::uint32_t vertex : {std::min(ends[0], ends[1]), std::max(ends[0], ends[1])})
    result = result << kVertexBits | feature.number(vertex);
  return result;
}

}  // namespace

std::span<const Contact> ConvexPatch::find(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                           const Vec3& normal, double depth, double size, double tolerance) {
  normal_ = normal + Vec3{};  // no −0
  depth_ = depth;
  near_ = kNear * size;
  const ContactPlane plane = plane_across(normal_, centre((o1.body().half_space() ? o2 : o1).box()), size);
  features_[0].find(o1, -normal_, plane);
  features_[1].find(o2, normal_, plane);
  clip();
  contacts_.clear();
  for (const Vec2& at : corners_) add_contact(at);
  std::ranges::sort(contacts_, {}, [](const Contact& c) { return std::pair(-c.depth, c.id); });
  if (!contacts_.empty() && contacts_.front().depth < depth - tolerance) contacts_.clear();
  return contacts_;
}

// The part in common, after Sutherland and Hodgman: the feature with fewer corners is cut off along the sides
// of the other one. A segment or a point is a polygon, too.
void ConvexPatch::clip() {
  const bool swapped = features_[0].corners().size() > features_[1].corners().size();
  const SupportFeature &cut = features_[swapped ? 1 : 0], &by = features_[swapped ? 0 : 1];
  corners_.clear();
  if (cut.everywhere()) {
    for (const SupportFeature::Corner& corner : by.corners()) corners_.push_back(corner.at);
    return;
  }
  for (const SupportFeature::Corner& corner : cut.corners()) corners_.push_back(corner.at);
  const std::span<const SupportFeature::Corner> sides = by.corners();
  if (sides.size() == 2 && cut.corners().size() == 2) return cross_segments();
  if (sides.size() < 3) {
    // A point on a segment or on a point.
    if (squared_distance(corners_[0], sides.front().at, sides.back().at) > near_ * near_) corners_.clear();
    return;
  }
  for (std::size_t i = 0; i < sides.size(); ++i) clip_by(sides[i].at, sides[(i + 1) % sides.size()].at);
}

// Keeps what is to the left of the line from a to b, or next to it.
void ConvexPatch::clip_by(const Vec2& a, const Vec2& b) {
  const Vec2 side = b - a;
  const double length = std::sqrt(dot(side, side));
  const auto height = [&](const Vec2& p) { return cross(side, p - a) / length; };
  clipped_.clear();
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Vec2 &p = corners_[i], &q = corners_[(i + 1) % corners_.size()];
    const double at_p = height(p), at_q = height(q);
    if (at_p >= -near_) clipped_.push_back(p);
    if ((at_p > near_ && at_q < -near_) || (at_p < -near_ && at_q > near_))
      clipped_.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  std::swap(corners_, clipped_);
}

// Two segments have a point in common, or lie along each other.
void ConvexPatch::cross_segments() {
  const std::array ends{features_[0].corners(), features_[1].corners()};
  corners_.clear();
  for (int i = 0; i < 2; ++i)
    for (const SupportFeature::Corner& corner : ends[i])
      if (squared_distance(corner.at, ends[1 - i][0].at, ends[1 - i][1].at) <= near_ * near_)
        corners_.push_back(corner.at);
  if (!corners_.empty()) return;
  const Vec2 &a = ends[0][0].at, along = ends[0][1].at - a, &b = ends[1][0].at, other = ends[1][1].at - b;
  const double sine = cross(along, other), s = cross(b - a, other) / sine, t = cross(b - a, along) / sine;
  if (s >= 0 && s <= 1 && t >= 0 && t <= 1) corners_.push_back(a + s * along);
}

// A corner of the part that is a vertex has its name, so that rounding does not change it.
void ConvexPatch::add_contact(const Vec2& at) {
  Contact contact{.normal = normal_, .id = kOfPatch};
  std::array<std::size_t, 2> corner{};
  for (int i = 0; i < 2; ++i) corner[i] = corner_at(features_[i], at, near_);
  const auto is_vertex = [&](int i) { return corner[i] < features_[i].corners().size(); };
  Vec2 place = at;
  if (is_vertex(0) || is_vertex(1)) {
    const int body = is_vertex(0) ? 0 : 1;
    const SupportFeature::Corner& vertex = features_[body].corners()[corner[body]];
    place = vertex.at;
    contact.id |= std::uint64_t(body) << kBodyShift | vertex.vertex;
  } else {
    contact.id |= kCrossing;
    contact.id |= side_at(features_[0], at) << 2 * kVertexBits | side_at(features_[1], at);
  }
  if (std::ranges::find(contacts_, contact.id, &Contact::id) != contacts_.end()) return;
  for (int i = 0; i < 2; ++i) {
    const SupportFeature::Above above =
        is_vertex(i) ? features_[i].at_corner(corner[i]) : features_[i].above(place);
    (i == 0 ? contact.point1 : contact.point2) = above.point;
    contact.on[i] = above.on;
  }
  contact.depth = std::min(dot(normal_, contact.point2 - contact.point1), depth_);
  contacts_.push_back(contact);
}

}  // namespace sdm::solids
