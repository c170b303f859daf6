#include "bodies/solids/support_feature.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "bodies/convex/support_search.h"
#include "geometry/unit_across.h"
#include "sites/sites_data.h"

namespace sdm::solids {
namespace {

constexpr double kTilt = 0.05;               // the sine of 3 degrees
constexpr double kNearlyParallel = 0.99875;  // its cosine
constexpr double kSameFace = 1 - 5e-7;       // the cosine between faces that continue each other
constexpr double kThin = 1e-9;               // of the size: a corner that is no farther from a line is on it

const Mesh& mesh_of(const shape::PosedBody& body) {
  return internals(body.body().sites()).mesh;
}

// Twice the area of a triangle, positive if it is counter-clockwise.
double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return cross(b - a, c - a);
}

}  // namespace

void SupportFeature::find(const shape::PosedBody& body, const Vec3& up, const ContactPlane& plane) {
  body_ = &body;
  plane_ = plane;
  faces_.clear();
  corners_.clear();
  up_ = up;
  core_.reset();
  lift_ = body.pose().scale * body.body().core().radius * up;
  if (!body.body().has_mesh()) {
    core_.emplace(body);
    return find_core(up);
  }
  convex_ = body.body().convex_solid();
  const auto& rows = body.pose().map.rows;
  const Vec3 local = normalized(up[0] * rows[0] + up[1] * rows[1] + up[2] * rows[2]);
  const std::uint32_t farthest = convex::farthest_vertex(*convex_, local);
  std::uint32_t best = kNone;
  double most = kNearlyParallel;
  for (const convex::Spoke& spoke : convex_->spokes.of(farthest))
    for (const std::uint32_t face : spoke.faces)
      if (const double along = dot(convex_->normals[face], local); along > most) {
        most = along;
        best = face;
      }
  has_area_ = best != kNone;
  if (has_area_) return find_faces(best);
  find_edge(farthest, local);
}

void SupportFeature::add_corner(const Vec3& p, std::uint32_t number) {
  corners_.push_back({plane_(p), number});
  core_points_.push_back(p + lift_);
}

// The feature of an axis with discs (a cylinder): the disc at an end, a line along the side, or the farthest
// point of either. Numbers are those of the places of a disc, of which each end has as many.
void SupportFeature::find_core(const Vec3& up) {
  constexpr std::uint32_t kOfDisc = 8, kSide = kOfDisc, kPlaces = kOfDisc + 1;
  has_area_ = false;
  core_points_.clear();
  if (everywhere()) return;
  const Vec3& axis = core_->axis();
  const double along = dot(axis, up);
  const std::uint32_t farther = along < 0 ? 1 : 0;
  const auto end = [&](std::uint32_t i) { return core_->centre() + (i == 0 ? 1.0 : -1.0) * core_->half(); };
  if (core_->disc() > 0 && std::abs(along) > kNearlyParallel) {
    const Vec3 x = unit_across(axis);
    const Vec3 y = cross(axis, x);
    for (std::uint32_t i = 0; i < kOfDisc; ++i) {
      const double angle = 2 * std::numbers::pi * i / kOfDisc;
      add_corner(end(farther) + core_->disc() * (std::cos(angle) * x + std::sin(angle) * y),
                 farther * kPlaces + i);
    }
    if (twice_area(corners_[0].at, corners_[1].at, corners_[2].at) < 0) {
      std::ranges::reverse(corners_);
      std::ranges::reverse(core_points_);
    }
    return;
  }
  const Vec3 across = up - along * axis;
  const Vec3 rim = core_->disc() > 0 ? core_->disc() * normalized(across) : Vec3{};
  const bool both = std::abs(along) < kTilt && core_->half() != Vec3{};
  for (const std::uint32_t i : {0U, 1U})
    if (both || i == farther) add_corner(end(i) + rim, i * kPlaces + kSide);
}

// The point of the plane of the corners, or of the half-space, above a point.
SupportFeature::Above SupportFeature::above_core(const Vec2& at) const {
  if (core_points_.size() == 1) return {core_points_[0], {}};
  if (core_points_.size() == 2) {
    const Vec2 side = corners_[1].at - corners_[0].at;
    const double t = std::clamp(dot(at - corners_[0].at, side) / dot(side, side), 0.0, 1.0);
    return {core_points_[0] + t * (core_points_[1] - core_points_[0]), {}};
  }
  const Vec3 of_plane = core_points_.empty() ? core_->centre() : core_points_[0];
  const Vec3& normal = core_points_.empty() ? core_->normal() : core_->axis();
  const Vec3 p = plane_.origin + at[0] * plane_.axes[0] + at[1] * plane_.axes[1];
  return {p + dot(normal, of_plane - p) / dot(normal, up_) * up_, {}};
}

std::uint64_t SupportFeature::number(std::uint32_t vertex) const {
  if (core_) return vertex;
  return static_cast<std::uint64_t>(std::ranges::lower_bound(convex_->vertex, vertex) -
                                    convex_->vertex.begin());
}

// The edge at the vertex that falls off least, or the vertex alone.
void SupportFeature::find_edge(std::uint32_t vertex, const Vec3& up) {
  double least = kTilt;
  std::uint32_t end = kNone;
  faces_.assign(1, convex_->first_face[vertex]);
  for (const convex::Spoke& spoke : convex_->spokes.of(vertex)) {
    const Vec3 along = convex_->points[vertex] - convex_->points[spoke.end];
    if (const double drop = dot(up, along) / norm(along); drop < least) {
      least = drop;
      end = spoke.end;
      faces_[0] = spoke.first_face();
    }
  }
  for (const std::uint32_t v : {vertex, end})
    if (v != kNone) corners_.push_back({plane_(point(convex_->vertex[v])), convex_->vertex[v]});
}

// All faces around the best one that continue it.
void SupportFeature::find_faces(std::uint32_t best) {
  const sites::SitesData& sites = internals(body_->body().sites());
  if (marks_.size() < sites.mesh.triangles.size()) marks_.resize(sites.mesh.triangles.size());
  if (++search_ == 0) {
    std::ranges::fill(marks_, 0);
    search_ = 1;
  }
  const auto add = [&](std::uint32_t face) {
    if (marks_[face] == search_ || dot(convex_->normals[best], convex_->normals[face]) < kSameFace) return;
    marks_[face] = search_;
    faces_.push_back(face);
  };
  add(best);
  for (std::size_t next = 0; next < faces_.size(); ++next)
    for (const std::uint32_t edge : sites.topology.face_edges[faces_[next]])
      for (const std::uint32_t face : sites.topology.edge_faces(edge)) add(face);
  places_.clear();
  for (const std::uint32_t face : faces_)
    for (const std::uint32_t vertex : sites.mesh.triangles[face])
      places_.push_back({plane_(point(vertex)), vertex});
  find_outline();
}

// The convex hull of the places, by Andrew's monotone chain.
void SupportFeature::find_outline() {
  std::ranges::sort(places_, {}, [](const Corner& c) { return std::tuple(c.at[0], c.at[1], c.vertex); });
  const auto same = [](const Corner& a, const Corner& b) { return a.vertex == b.vertex; };
  places_.erase(std::unique(places_.begin(), places_.end(), same), places_.end());
  const auto add = [&](const Corner& corner, std::size_t first) {
    while (corners_.size() > first + 1) {
      const Vec2 &a = corners_[corners_.size() - 2].at, &b = corners_.back().at, side = corner.at - a;
      if (twice_area(a, b, corner.at) > kThin * plane_.size * std::sqrt(dot(side, side))) break;
      corners_.pop_back();
    }
    corners_.push_back(corner);
  };
  for (const Corner& corner : places_) add(corner, 0);
  const std::size_t last = corners_.size() - 1;
  for (std::size_t i = places_.size() - 1; i-- > 0;) add(places_[i], last);
  if (corners_.size() > 1) corners_.pop_back();  // the first one again
}

Vec3 SupportFeature::point(std::uint32_t vertex) const {
  return body_->pose().map(mesh_of(*body_).positions[vertex]);
}

SupportFeature::Above SupportFeature::between(std::uint32_t face, const Vec3& weights) const {
  const Mesh& mesh = mesh_of(*body_);
  Vec3 p{};
  for (int k = 0; k < 3; ++k) p += weights[k] * mesh.positions[mesh.triangles[face][k]];
  return {body_->pose().map(p) + lift_, {face, weights}};
}

SupportFeature::Above SupportFeature::at_corner(std::size_t corner) const {
  if (core_) return {core_points_[corner], {}};
  const std::uint32_t vertex = corners_[corner].vertex;
  for (const std::uint32_t face : faces_) {
    const Triangle& triangle = mesh_of(*body_).triangles[face];
    for (int k = 0; k < 3; ++k) {
      Vec3 weights{};
      weights[k] = 1;
      if (triangle[k] == vertex) return between(face, weights);
    }
  }
  return {};
}

SupportFeature::Above SupportFeature::above(const Vec2& at) const {
  if (core_) return above_core(at);
  if (corners_.size() > 2) return above_face(at);
  if (corners_.size() == 2 && !has_area_) return above_edge(at);
  const auto squared = [&](const Corner& corner) { return dot(corner.at - at, corner.at - at); };
  return at_corner(squared(corners_.front()) <= squared(corners_.back()) ? 0 : corners_.size() - 1);
}

// The point is on the face that contains it, or that it is least outside of.
SupportFeature::Above SupportFeature::above_face(const Vec2& at) const {
  const Mesh& mesh = mesh_of(*body_);
  double most = -kInfinity;
  std::uint32_t best = faces_[0];
  Vec3 weights{1, 0, 0};
  for (const std::uint32_t face : faces_) {
    std::array<Vec2, 3> corner;
    for (int k = 0; k < 3; ++k) corner[k] = plane_(point(mesh.triangles[face][k]));
    const double area = twice_area(corner[0], corner[1], corner[2]);
    Vec3 found;
    for (int k = 0; k < 3; ++k) found[k] = twice_area(at, corner[(k + 1) % 3], corner[(k + 2) % 3]) / area;
    if (const double least = std::min({found[0], found[1], found[2]}); least > most) {
      most = least;
      best = face;
      weights = found;
    }
  }
  for (double& w : weights) w = std::max(w, 0.0);
  return between(best, (1 / (weights[0] + weights[1] + weights[2])) * weights);
}

SupportFeature::Above SupportFeature::above_edge(const Vec2& at) const {
  const Vec2 &a = corners_[0].at, side = corners_[1].at - a;
  const double t = std::clamp(dot(at - a, side) / dot(side, side), 0.0, 1.0);
  const Triangle& triangle = mesh_of(*body_).triangles[faces_[0]];
  Vec3 weights{};
  for (int k = 0; k < 3; ++k) {
    if (triangle[k] == corners_[0].vertex) weights[k] = 1 - t;
    if (triangle[k] == corners_[1].vertex) weights[k] = t;
  }
  return between(faces_[0], weights);
}

}  // namespace sdm::solids
