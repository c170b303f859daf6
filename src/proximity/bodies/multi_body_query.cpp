#include <sdm/error.h>
#include <sdm/multi_body_query.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include "core/cancellation.h"
#include "core/intact.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "mesh/similarity.h"
#include "proximity/bodies/body_parts.h"
#include "proximity/bodies/contact_store.h"
#include "proximity/bodies/internal_contacts.h"
#include "proximity/bodies/moving_bodies.h"
#include "proximity/bodies/near_pairs.h"
#include "proximity/bodies/nearest_body.h"
#include "proximity/bodies/pool.h"
#include "proximity/motion/divided_motion.h"
#include "proximity/pair/pair_answers.h"
#include "query/shape/posed_body.h"

namespace sdm {
namespace {

const MultiBodyOptions& checked(const MultiBodyOptions& options) {
  pair::check_options(options.contact_margin, options.depth_precision);
  return options;
}
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

struct MultiBodyQuery::Impl {
  MultiBodyOptions options;
  bodies::BodyParts parts;
  std::vector<shape::PosedBody> posed;       // the parts, and so in `near`
  std::vector<Transform> given_poses;        // of bodies
  Intact intact{"a MultiBodyQuery object"};  // every call but construction requires it first
  bodies::Pool<pair::PairAnswers> pool;
  bodies::NearPairs near;
  std::vector<std::size_t> unknown;  // the pairs of `near` that a call computes

  // What the calls have returned.
  std::vector<BodyPair> colliding;
  std::vector<PairSeparation> separations;
  std::size_t candidates = 0;
  std::vector<PairDepth> depths;
  std::vector<PairContacts> contacts;
  bodies::ContactStore stored_contacts;
  bodies::InternalContacts internal_contacts;

  Impl(std::vector<Shape> shapes, bodies::BodyParts of_bodies, const MultiBodyOptions& asked)
      : options(asked), parts(std::move(of_bodies)), given_poses(parts.bodies()), near(parts.body_of()) {
    posed.reserve(shapes.size());
    for (Shape& shape : shapes) posed.emplace_back(std::move(shape));
    for (std::uint32_t part = 0; part < posed.size(); ++part)
      if (parts.any_compound()) posed[part].set_pose(parts.pose_of(part, {}));
  }

  [[nodiscard]] std::size_t checked(std::size_t body) const {
    intact.require();
    if (body >= parts.bodies())
      throw Error("there is no body " + std::to_string(body) + " among " + std::to_string(parts.bodies()) +
                  "; they are numbered from 0");
    return body;
  }
  [[nodiscard]] const shape::PosedBody& part_of(std::size_t body, std::size_t part) const {
    return posed[parts.checked(checked(body), part)];
  }
  [[nodiscard]] Sweep::Pair checked_pair(std::size_t a, std::size_t b) const {
    if (checked(a) == checked(b))
      throw Error("body " + std::to_string(a) + " and itself are no pair; give two bodies");
    return {static_cast<std::uint32_t>(std::min(a, b)), static_cast<std::uint32_t>(std::max(a, b))};
  }
  void check_count(std::size_t count, const char* what) const {
    intact.require();
    if (count != parts.bodies())
      throw Error("there are " + std::to_string(parts.bodies()) + " bodies, but " + what + " for " +
                  std::to_string(count) + " were given; give one entry per body");
  }
  void check(std::size_t body, std::span<const Vec3> positions) const {
    on_behalf_of(body, [&] {
      parts.require_one_shape(body, "vertices that can be moved");
      posed[parts.begin(body)].check_refit(positions);
    });
  }

  // Compares bits, since 0 and −0 may give zeros of other signs.
  [[nodiscard]] bool has_pose(std::size_t body, const Transform& pose) const {
    return std::memcmp(&given_poses[body], &pose, sizeof pose) == 0;
  }
  void set_pose(std::size_t body, const Transform& pose) {
    if (has_pose(body, pose)) return;
    if (parts.count(body) > 1) check_pose(body, pose);
    for (std::uint32_t part = parts.begin(body); part < parts.end(body); ++part) {
      on_behalf_of(body, [&] { posed[part].set_pose(parts.pose_of(part, pose)); });
      near.moved(part);
    }
    given_poses[body] = pose;
  }
  void check_pose(std::size_t body, const Transform& pose) const {
    on_behalf_of(body, [&] {
      for (std::uint32_t part = parts.begin(body); part < parts.end(body); ++part)
        (void)posed[part].checked_pose(parts.pose_of(part, pose));
    });
  }

  // Calls compute(answers, i) for the pairs within `reach` that is_unknown(pair), on all cores, where i
  // counts them; and keeps what is then known.
  template <class IsUnknown, class Compute>
  void complete(double reach, const IsUnknown& is_unknown, const Compute& compute) {
    near.follow(posed, reach);
    unknown.clear();
    const std::span<bodies::NearPair> pairs = near.list();
    for (std::size_t i = 0; i < pairs.size(); ++i)
      if (pairs[i].gap <= reach && is_unknown(pairs[i])) unknown.push_back(i);
    const auto compute_some = [&](std::size_t begin, std::size_t end) {
      std::unique_ptr<pair::PairAnswers> answers = pool.take([&] {
        return std::make_unique<pair::PairAnswers>(options.contact_margin, options.depth_precision);
      });
      for (std::size_t u = begin; u < end; ++u) {
        bodies::NearPair& pair = pairs[unknown[u]];
        bodies::PairState& state = near.state(pair);
        answers->begin(posed[pair.pair[0]], posed[pair.pair[1]], state.known);
        compute(*answers, u);
        state.known = answers->known();
        pair.set(state.known);
      }
      pool.give_back(std::move(answers));
    };
    parallel_for(unknown.size(), 1, compute_some);
  }

  void find_colliding() {
    complete(
        0, [](const bodies::NearPair& pair) { return !pair.collision_known; },
        [](pair::PairAnswers& answers, std::size_t) { (void)answers.colliding(); });
    colliding.clear();
    for (const bodies::NearPair& pair : near.list())
      if (pair.colliding) colliding.push_back({pair.pair[0], pair.pair[1]});
    parts.merge(colliding);
  }

  void find_separations(double max_distance) {
    const auto is_unknown = [&](const bodies::NearPair& pair) {
      return !pair.collision_known ||
             !(pair.separation_known || (pair.apart >= max_distance && !pair.colliding));
    };
    complete(max_distance, is_unknown, [&](pair::PairAnswers& answers, std::size_t) {
      if (answers.within(max_distance)) (void)answers.separation(), (void)answers.colliding();
    });
    candidates = 0;
    for (const bodies::NearPair& pair : near.list()) candidates += pair.gap <= max_distance;
    const auto list_if = [&](const auto& is_listed) {
      separations.clear();
      for (const bodies::NearPair& pair : near.list())
        if (is_listed(pair))
          separations.push_back(
              {pair.pair[0], pair.pair[1], *near.state(pair).known.separation, pair.colliding});
      parts.merge(separations);
    };
    const auto is_near = [&](const bodies::NearPair& pair) {
      return pair.gap <= max_distance &&
             (pair.colliding || (pair.separation_known && pair.apart <= max_distance));
    };
    list_if(is_near);
    if (!parts.any_compound()) return;

    // A part inside another one may be farther from its surface than other parts of the same bodies are.
    double reach = 0;
    colliding.clear();
    for (const PairSeparation& pair : separations)
      if (pair.colliding && pair.separation.value > max_distance) {
        colliding.push_back({pair.first, pair.second});
        reach = std::max(reach, pair.separation.value);
      }
    if (colliding.empty()) return;
    const auto is_contained = [&](const bodies::NearPair& pair) {
      const std::array bodies{parts.body_of()[pair.pair[0]], parts.body_of()[pair.pair[1]]};
      return std::ranges::binary_search(colliding, bodies, {}, [](const BodyPair& known) {
        return std::array{known.first, known.second};
      });
    };
    complete(
        reach, [&](const bodies::NearPair& pair) { return is_contained(pair) && !pair.separation_known; },
        [](pair::PairAnswers& answers, std::size_t) {
          (void)answers.separation(), (void)answers.colliding();
        });
    list_if([&](const bodies::NearPair& pair) {
      return is_near(pair) || (is_contained(pair) && pair.separation_known);
    });
  }

  void find_depths() {
    const auto is_unknown = [](const bodies::NearPair& pair) {
      return !pair.collision_known || (pair.colliding && !pair.depth_known);
    };
    complete(0, is_unknown, [](pair::PairAnswers& answers, std::size_t) {
      if (answers.colliding()) (void)answers.penetration_depth();
    });
    depths.clear();
    for (const bodies::NearPair& pair : near.list()) {
      if (!pair.colliding) continue;
      if (const std::optional<BoundedLength>& depth = *near.state(pair).known.depth)
        depths.push_back({pair.pair[0], pair.pair[1], *depth});
    }
    parts.merge(depths);
  }

  void find_contacts() {
    near.follow(posed, options.contact_margin);
    stored_contacts.begin(near.list().size());
    complete(
        options.contact_margin, [](const bodies::NearPair& pair) { return !pair.contacts_known; },
        [&](pair::PairAnswers& answers, std::size_t u) { stored_contacts.found(u, answers.contacts()); });
    stored_contacts.store(near, unknown);
    contacts.clear();
    for (const bodies::NearPair& pair : near.list())
      if (pair.touching)
        contacts.push_back({pair.pair[0], pair.pair[1], stored_contacts.of(near.state(pair))});
    if (options.ignore_internal_edges) {
      internal_contacts.follow(posed, near.filter());
      internal_contacts.leave_out(contacts);
    }
    parts.merge(contacts);
  }
};

MultiBodyQuery::MultiBodyQuery(std::vector<Mesh> meshes, const MultiBodyOptions& options)
    : MultiBodyQuery(shapes_of(meshes), checked(options)) {}
MultiBodyQuery::MultiBodyQuery(std::vector<Shape> shapes, const MultiBodyOptions& options)
    : impl_(with_memory_of_bodies([&] {
        bodies::BodyParts parts(shapes.size());
        return std::make_unique<Impl>(std::move(shapes), std::move(parts), checked(options));
      })) {}
MultiBodyQuery::MultiBodyQuery(std::vector<std::vector<BodyPart>> bodies, const MultiBodyOptions& options) {
  with_memory_of_bodies([&] {
    std::vector<Shape> shapes;
    bodies::BodyParts parts(std::move(bodies), shapes);
    impl_ = std::make_unique<Impl>(std::move(shapes), std::move(parts), checked(options));
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
  const shape::PosedBody& part = impl_->part_of(body, 0);
  if (impl_->parts.compound(body)) return mesh::Similarity::of(impl_->given_poses[body]).transform();
  return part.pose().transform();
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

std::vector<PairTimeOfContact> MultiBodyQuery::time_of_contact(std::span<const Motion> motions,
                                                               double tolerance,
                                                               const TimeOfContactOptions& options) const {
  impl_->check_count(motions.size(), "motions");
  motion::check_tolerance(tolerance);
  if (!(options.until >= 0 && options.until <= 1))
    throw Error("contacts until the time " + std::to_string(options.until) +
                " are asked for; motions take place from 0 to 1");
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
  return impl_->part_of(body, part).body().sites();
}

}  // namespace sdm
