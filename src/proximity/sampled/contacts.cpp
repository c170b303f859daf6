#include "proximity/sampled/contacts.h"

#include <algorithm>
#include <limits>

#include "core/geometry/barycentric.h"
#include "core/geometry/vec.h"
#include "engine/cpu/cpu_engine.h"
#include "sites/sites_data.h"
#include "surface/sample_blocks.h"
#include "surface/surface_data.h"

namespace sdm::sampled {
namespace {

// The contact of a sample of body `body`, as defined by Contact, in space. `outwards` is the direction in
// which the other body pushes this one.
struct SampleContact {
  Vec3 sample, closest, outwards;
  double depth;
  std::uint32_t face, other_face;  // that contain the two points
  Vec3 weights, other_weights;     // barycentric coordinates there
};

Contact contact_of(int body, const SampleContact& c, std::uint64_t id) {
  Contact contact{.point1 = c.sample,
                  .point2 = c.closest,
                  .normal = body == 0 ? c.outwards : -c.outwards,
                  .depth = c.depth,
                  .faces = {c.face, c.other_face},
                  .barycentric = {c.weights, c.other_weights},
                  .id = id};
  if (body == 1) {
    std::swap(contact.point1, contact.point2);
    std::swap(contact.faces[0], contact.faces[1]);
    std::swap(contact.barycentric[0], contact.barycentric[1]);
  }
  return contact;
}

Vec3 weights_in(const Mesh& mesh, std::uint32_t face, const Vec3& p) {
  const auto& [a, b, c] = mesh.triangles[face];
  return barycentric(mesh.positions[a], mesh.positions[b], mesh.positions[c], p);
}

}  // namespace

std::span<const Contact> ContactFinder::find(const std::array<MeasuredBody, 2>& bodies, double margin,
                                             double length) {
  contacts_.clear();
  boxes_.clear();
  for (int body = 0; body < 2; ++body) {
    find_parts(bodies[body], bodies[1 - body].body.pose(), margin);
    add_contacts(bodies, body, length);
  }
  return patches_.sort(contacts_, boxes_);
}

void ContactFinder::find_parts(const MeasuredBody& body, const mesh::Similarity& measured_in, double margin) {
  const Surface& surface = body.body.body().surface();
  const std::span<const float> distances = body.distances.distances(), radii = body.distances.radii();
  const double limit = margin / measured_in.scale;
  parts_.clear();
  for (std::size_t b = 0; b < surface::block_count(distances.size()); ++b) {
    const surface::SampleBlock block(b, distances.size());
    const auto first_of_block = static_cast<std::ptrdiff_t>(parts_.size());
    for (std::size_t i = block.first; i < block.end; ++i) {
      if (!(distances[i] <= limit)) continue;
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
  const shape::Body& other = to.body.body();
  const sites::SitesData& sites = internals(other.sites());
  const surface::SurfaceData& surface = internals(on.body.body().surface());
  const mesh::Similarity& pose = to.body.pose();  // in which the samples are measured
  const auto in_space = [&](const Box& box) { return image(pose.map, box); };
  points_.clear();
  for (const Part& part : parts_) points_.push_back(on.distances.points()[part.deepest]);
  const auto add = [&](std::size_t first, const sites::ClosestPacket& closest) {
    for (std::size_t i = 0; i < closest.count; ++i) {
      const Part& part = parts_[first + i];
      const Vec3& p = points_[first + i];
      Vec3 vector{closest.vector[0][i], closest.vector[1][i], closest.vector[2][i]};
      std::uint32_t face = sites.face_of(closest.type[i], closest.site[i]);
      const Vec3 normal = sites.normals.face[face];
      const bool inside = on.distances.distances()[part.deepest] < 0;
      if (inside && !other.inside().at_boundary(p, closest.get(i, p))) {
        other.require_boundary();
        const auto boundary = other.boundary().closest(p);
        if (boundary.point) vector = *boundary.point - p, face = boundary.face;
      }
      Box box = part.box;
      if (!inside) extend(box, p + vector);  // across the gap
      boxes_.push_back(in_space(box));
      const double depth = pose.scale * (inside ? norm(vector) : -closest.distance[i]);
      const Vec3 direction = pose.map.linear(vector), sample = pose.map(p);
      const std::size_t index = on.distances.sample(part.deepest);
      const std::uint32_t sample_face = surface.sample_faces[index];
      Vec3 in_place;
      surface.place_samples(index, {&in_place, 1});
      contacts_.push_back(contact_of(
          body,
          {.sample = sample,
           .closest = sample + direction,
           .outwards = std::abs(depth) > length ? (1 / depth) * direction
                                                : (1 / pose.scale) * pose.map.linear(normal),
           .depth = depth,
           .face = sample_face,
           .other_face = face,
           .weights = weights_in(surface.mesh, sample_face, in_place),
           .other_weights = weights_in(sites.mesh, face, p + vector)},
          std::uint64_t(body) << 63 | std::uint64_t(part.chart) << 32 | index / surface::kBlockSize));
    }
  };
  cpu::cpu_search(sites, points_, std::numeric_limits<double>::infinity(), std::ref(add));
}

}  // namespace sdm::sampled
