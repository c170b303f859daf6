#include "proximity/sampled/contacts.h"

#include <algorithm>
#include <limits>

#include "core/geometry/vec.h"
#include "engine/cpu/cpu_engine.h"
#include "sites/sites_data.h"
#include "surface/sample_blocks.h"
#include "surface/surface_data.h"

namespace sdm::sampled {
namespace {

// The contact of a sample of body `body`, as defined by Contact; `outwards` is the direction in which the
// other body pushes this one.
Contact contact_of(int body, const Vec3& sample, const Vec3& vector, double depth, const Vec3& outwards) {
  Contact c{.point1 = sample, .point2 = sample + vector, .depth = depth};
  if (body == 1) std::swap(c.point1, c.point2);
  c.normal = body == 0 ? outwards : -outwards;
  return c;
}

}  // namespace

std::span<const Contact> ContactFinder::find(const std::array<MeasuredBody, 2>& bodies, double margin,
                                             double length) {
  contacts_.clear();
  boxes_.clear();
  for (int body = 0; body < 2; ++body) {
    find_parts(bodies[body], margin);
    add_contacts(bodies, body, length);
  }
  return patches_.sort(contacts_, boxes_);
}

void ContactFinder::find_parts(const MeasuredBody& body, double margin) {
  const Surface& surface = body.body.surface();
  const std::span<const float> distances = body.distances.distances(), radii = body.distances.radii();
  parts_.clear();
  for (std::size_t b = 0; b < surface::block_count(distances.size()); ++b) {
    const surface::SampleBlock block(b, distances.size());
    const auto first_of_block = static_cast<std::ptrdiff_t>(parts_.size());
    for (std::size_t i = block.first; i < block.end; ++i) {
      if (!(distances[i] <= margin)) continue;
      const std::uint32_t face = internals(surface).sample_faces[body.distances.sample(i)];
      const std::uint32_t chart = surface.face_charts()[face];
      auto part = std::find_if(parts_.begin() + first_of_block, parts_.end(),
                               [&](const Part& p) { return p.chart == chart; });
      if (part == parts_.end()) part = parts_.insert(part, {chart, i, {}});
      if (distances[i] < distances[part->deepest]) part->deepest = i;
      const Vec3& p = body.distances.points()[i];
      const Vec3 reach{radii[i], radii[i], radii[i]};
      extend(part->box, p - reach);
      extend(part->box, p + reach);
    }
  }
}

void ContactFinder::add_contacts(const std::array<MeasuredBody, 2>& bodies, int body, double length) {
  const MeasuredBody &on = bodies[body], &to = bodies[1 - body];
  const sites::SitesData& sites = internals(to.body.sites());
  points_.clear();
  for (const Part& part : parts_) {
    points_.push_back(on.distances.points()[part.deepest]);
    boxes_.push_back(part.box);
  }
  const auto add = [&](std::size_t first, const sites::ClosestPacket& closest) {
    for (std::size_t i = 0; i < closest.count; ++i) {
      Vec3 vector{closest.vector[0][i], closest.vector[1][i], closest.vector[2][i]};
      const bool inside = on.distances.distances()[parts_[first + i].deepest] < 0;
      if (inside && !to.body.inside().at_boundary(points_[first + i], closest.get(i, points_[first + i]))) {
        to.body.require_boundary();
        const auto boundary = to.body.boundary().closest(points_[first + i]);
        if (boundary.point) vector = *boundary.point - points_[first + i];
      }
      const std::uint32_t face = sites.face_of(closest.type[i], closest.site[i]);
      if (!inside) extend(boxes_[contacts_.size()], points_[first + i] + vector);  // across the gap
      const double depth = inside ? norm(vector) : -closest.distance[i];
      const Vec3 outwards = std::abs(depth) > length ? (1 / depth) * vector : sites.normals.face[face];
      contacts_.push_back(contact_of(body, points_[first + i], vector, depth, outwards));
    }
  };
  cpu::cpu_search(sites, points_, std::numeric_limits<double>::infinity(), std::ref(add));
}

}  // namespace sdm::sampled
