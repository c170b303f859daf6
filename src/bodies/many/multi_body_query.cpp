#include <sdm/error.h>
#include <sdm/multi_body_query.h>

#include <memory>
#include <new>
#include <string>
#include <utility>

#include "bodies/many/moving_bodies.h"
#include "bodies/many/multi_body_impl.h"
#include "bodies/many/nearest_body.h"
#include "bodies/motion/divided_motion.h"
#include "core/cancellation.h"
#include "core/memory.h"
#include "core/parallel.h"

namespace sdm {
namespace {

void check_distance(double max_distance) {
  if (!(max_distance > 0)) throw Error("the maximum distance must be greater than 0");
}

std::vector<Shape> shapes_of(std::span<const Mesh> meshes) {
  std::vector<Shape> shapes;
  shapes.reserve(meshes.size());
  for (const Mesh& mesh : meshes) bodies::on_behalf_of(shapes.size(), [&] { shapes.emplace_back(mesh); });
  return shapes;
}

// Calls `work`, whose errors of memory become sdm::Error.
template <class Work>
decltype(auto) with_memory_of_bodies(const Work& work) try {
  return work();
} catch (const std::bad_alloc&) {
  throw out_of_memory("a query of many bodies");
}

using bodies::on_behalf_of;

}  // namespace

MultiBodyQuery::MultiBodyQuery(std::vector<Mesh> meshes, const ProximityOptions& options)
    : MultiBodyQuery(shapes_of(meshes), pair::checked(options)) {}
MultiBodyQuery::MultiBodyQuery(std::vector<Shape> shapes, const ProximityOptions& options)
    : impl_(with_memory_of_bodies([&] {
        bodies::BodyParts parts(shapes.size());
        return std::make_unique<Impl>(std::move(shapes), std::move(parts), pair::checked(options));
      })) {}
MultiBodyQuery::MultiBodyQuery(std::vector<std::vector<BodyPart>> bodies, const ProximityOptions& options) {
  with_memory_of_bodies([&] {
    std::vector<Shape> shapes;
    bodies::BodyParts parts(std::move(bodies), shapes);
    impl_ = std::make_unique<Impl>(std::move(shapes), std::move(parts), pair::checked(options));
  });
}
MultiBodyQuery::~MultiBodyQuery() = default;
MultiBodyQuery::MultiBodyQuery(MultiBodyQuery&&) noexcept = default;
MultiBodyQuery& MultiBodyQuery::operator=(MultiBodyQuery&&) noexcept = default;

std::size_t MultiBodyQuery::size() const {
  impl_->intact.require();
  return impl_->parts.bodies();
}
std::size_t MultiBodyQuery::part_count(std::size_t body) const {
  return impl_->parts.count(impl_->checked(body));
}

void MultiBodyQuery::set_pose(std::size_t body, const Transform& pose) {
  impl_->set_pose(impl_->checked(body), pose);
}

void MultiBodyQuery::set_poses(std::span<const Transform> poses) {
  impl_->check_count(poses.size(), "poses");
  for (std::size_t b = 0; b < size(); ++b)
    if (!impl_->has_pose(b, poses[b])) impl_->check_pose(b, poses[b]);
  for (std::size_t b = 0; b < size(); ++b) impl_->set_pose(b, poses[b]);
}

Transform MultiBodyQuery::pose(std::size_t body) const {
  return impl_->pose(impl_->checked(body));
}
Transform MultiBodyQuery::part_pose(std::size_t body, std::size_t part) const {
  return impl_->part_of(body, part).pose().transform();
}

void MultiBodyQuery::refit(std::size_t body, std::span<const Vec3> positions) {
  const Uncancellable whole;
  impl_->check(impl_->checked(body), positions);
  const std::uint32_t p = impl_->parts.begin(body);
  impl_->near.moved(p);
  with_memory_of_bodies([&] { impl_->intact.change([&] { impl_->posed[p].refit(positions); }); });
}

void MultiBodyQuery::refit(std::span<const std::span<const Vec3>> positions) {
  const Uncancellable whole;
  impl_->check_count(positions.size(), "positions");
  for (std::size_t b = 0; b < size(); ++b)
    if (!positions[b].empty()) impl_->check(b, positions[b]);
  for (std::size_t b = 0; b < size(); ++b)
    if (!positions[b].empty()) impl_->near.moved(impl_->parts.begin(b));
  const auto refit = [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      if (!positions[b].empty()) impl_->posed[impl_->parts.begin(b)].refit(positions[b]);
  };
  with_memory_of_bodies([&] { impl_->intact.change([&] { parallel_for(positions.size(), 1, refit); }); });
}

void MultiBodyQuery::set_filter(std::size_t body, const BodyFilter& filter) {
  const std::size_t number = impl_->checked(body);
  bodies::PairFilter& filters = impl_->near.change_filter();
  for (std::uint32_t part = impl_->parts.begin(number); part < impl_->parts.end(number); ++part)
    filters[part] = filter;
}

BodyFilter MultiBodyQuery::filter(std::size_t body) const {
  return impl_->near.filter()[impl_->parts.begin(impl_->checked(body))];
}

void MultiBodyQuery::exclude_pair(std::size_t a, std::size_t b) {
  const Sweep::Pair pair = impl_->checked_pair(a, b);
  with_memory_of_bodies([&] { impl_->near.change_filter().exclude(pair); });
}

void MultiBodyQuery::include_pair(std::size_t a, std::size_t b) {
  const Sweep::Pair pair = impl_->checked_pair(a, b);
  impl_->near.change_filter().include(pair);
}

std::span<const BodyPair> MultiBodyQuery::colliding() {
  impl_->intact.require();
  with_memory_of_bodies([&] { impl_->find_colliding(); });
  return impl_->colliding;
}

std::span<const PairSeparation> MultiBodyQuery::separations(double max_distance) {
  impl_->intact.require();
  check_distance(max_distance);
  with_memory_of_bodies([&] { impl_->find_separations(max_distance); });
  return impl_->separations;
}

std::span<const PairDepth> MultiBodyQuery::penetration_depths() {
  impl_->intact.require();
  with_memory_of_bodies([&] { impl_->find_depths(); });
  return impl_->depths;
}

std::span<const PairContacts> MultiBodyQuery::contacts() {
  impl_->intact.require();
  with_memory_of_bodies([&] { impl_->find_contacts(); });
  return impl_->contacts;
}

std::span<const PairTranslation> MultiBodyQuery::separating_translations() {
  impl_->intact.require();
  with_memory_of_bodies([&] { impl_->find_translations(); });
  return impl_->translations;
}

std::span<const PairContacts> MultiBodyQuery::separating_contacts(std::optional<std::size_t> most_per_patch) {
  impl_->intact.require();
  if (most_per_patch == 0) throw Error("0 contacts of each patch are too few; use 1 or more");
  with_memory_of_bodies([&] { impl_->find_separating_contacts(most_per_patch); });
  return impl_->separating_contacts;
}

std::vector<PairTimeOfContact> MultiBodyQuery::time_of_contact(std::span<const Motion> motions,
                                                               double tolerance,
                                                               const TimeOfContactOptions& options) const {
  impl_->check_count(motions.size(), "motions");
  motion::check_tolerance(tolerance);
  check_options(options);
  return with_memory_of_bodies([&] {
    const std::vector<motion::DividedMotion> divided = impl_->parts.divided(impl_->posed, motions);
    std::vector<PairTimeOfContact> contacts =
        bodies::MovingBodies(impl_->posed, divided).first_contacts(impl_->near.filter(), tolerance, options);
    impl_->parts.merge(contacts);
    return contacts;
  });
}

std::vector<Transform> MultiBodyQuery::poses_at(std::span<const Motion> motions, double time) const {
  return with_memory_of_bodies([&] {
    impl_->check_count(motions.size(), "motions");
    std::vector<Transform> poses;
    poses.reserve(motions.size());
    for (const Motion& m : motions)
      on_behalf_of(poses.size(),
                   [&] { poses.push_back(impl_->parts.pose_at(poses.size(), impl_->posed, m, time)); });
    return poses;
  });
}

std::size_t MultiBodyQuery::candidate_pairs() const {
  impl_->intact.require();
  return impl_->candidates;
}

NearestMap MultiBodyQuery::nearest_map(std::size_t body, double max_distance) const try {
  NearestMap nearest;
  nearest_map(body, max_distance, nearest);
  return nearest;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a map of the nearest bodies");
}

void MultiBodyQuery::nearest_map(std::size_t body, double max_distance, NearestMap& nearest) const try {
  check_distance(max_distance);
  on_behalf_of(impl_->checked(body), [&] {
    impl_->parts.require_one_shape(body, "map");
    bodies::map_nearest(impl_->posed, impl_->parts.begin(body), max_distance, nearest);
  });
  impl_->parts.merge(nearest);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a map of the nearest bodies");
}

const Surface& MultiBodyQuery::surface(std::size_t body, std::size_t part) const {
  const shape::Body& of = impl_->part_of(body, part).body();
  const Surface* surface = nullptr;
  on_behalf_of(body, [&] { surface = &of.surface(); });
  return *surface;
}
const Sites& MultiBodyQuery::sites(std::size_t body, std::size_t part) const {
  const shape::Body& of = impl_->part_of(body, part).body();
  // Distances to the sites are not those to the body.
  if (of.has_mesh() && of.rounded())
    throw Error("body " + std::to_string(body) +
                " has a margin, which its sites have not; use Shape::sites()");
  return of.sites();
}

}  // namespace sdm
