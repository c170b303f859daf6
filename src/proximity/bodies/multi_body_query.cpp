#include <sdm/error.h>
#include <sdm/multi_body_query.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <new>
#include <string>
#include <utility>

#include "core/cancellation.h"
#include "core/intact.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/boxes/sweep.h"
#include "proximity/bodies/nearest_body.h"
#include "proximity/pair/pair_answers.h"
#include "query/shape/posed_body.h"

namespace sdm {
namespace {

const MultiBodyOptions& checked(const MultiBodyOptions& options) {
  if (!(options.max_distance > 0)) throw Error("the maximum distance must be greater than 0");
  pair::check_options(options.contact_margin, options.depth_precision);
  return options;
}

// Adds the body to the messages of errors thrown by `work`.
template <class Work>
void on_behalf_of(std::size_t body, const Work& work) {
  try {
    work();
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    throw Error("body " + std::to_string(body) + ": " + error.what(), error.remedy());
  }
}

std::vector<Shape> shapes_of(std::span<const Mesh> meshes) {
  std::vector<Shape> shapes;
  shapes.reserve(meshes.size());
  for (const Mesh& mesh : meshes) on_behalf_of(shapes.size(), [&] { shapes.emplace_back(mesh); });
  return shapes;
}

// A pool of the memory for pairs measured concurrently: one entry for each thread.
class AnswersPool {
 public:
  explicit AnswersPool(const MultiBodyOptions& options)
      : contact_margin_(options.contact_margin), depth_precision_(options.depth_precision) {}

  std::unique_ptr<pair::PairAnswers> take() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return std::make_unique<pair::PairAnswers>(contact_margin_, depth_precision_);
    std::unique_ptr<pair::PairAnswers> answers = std::move(idle_.back());
    idle_.pop_back();
    return answers;
  }
  void give_back(std::unique_ptr<pair::PairAnswers> answers) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(answers));
  }

 private:
  double contact_margin_;
  std::optional<double> depth_precision_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<pair::PairAnswers>> idle_;
};

}  // namespace

struct MultiBodyQuery::Impl {
  MultiBodyOptions options;
  std::vector<shape::PosedBody> bodies;
  Intact intact{"a MultiBodyQuery object"};  // every call but construction requires it first
  AnswersPool pool;
  Sweep sweep;
  std::vector<Box> boxes;

  struct ClosestFaces {
    Sweep::Pair pair{};
    pair::FacePair faces = pair::kNoFaces;
  };
  std::vector<ClosestFaces> hints, closest_faces;  // sorted by pair: of the last search, of this one

  // Results since a body last moved.
  bool pairs_found = false, contacts_found = false;
  std::size_t candidates = 0;
  std::vector<PairProximity> pairs;
  std::vector<std::vector<BodyContact>> contacts_of;  // each candidate pair
  std::vector<BodyContact> contacts;

  Impl(std::vector<Shape> shapes, const MultiBodyOptions& asked)
      : options(asked), pool(asked), boxes(shapes.size()) {
    bodies.reserve(shapes.size());
    for (Shape& shape : shapes) bodies.emplace_back(std::move(shape));
  }

  void moved() { pairs_found = contacts_found = false; }

  [[nodiscard]] std::size_t checked(std::size_t body) const {
    intact.require();
    if (body >= bodies.size())
      throw Error("there is no body " + std::to_string(body) + " among " + std::to_string(bodies.size()) +
                  "; they are numbered from 0");
    return body;
  }
  void check_count(std::size_t count, const char* what) const {
    intact.require();
    if (count != bodies.size())
      throw Error("there are " + std::to_string(bodies.size()) + " bodies, but " + what + " for " +
                  std::to_string(count) + " were given; give one entry per body");
  }
  void check(std::size_t body, std::span<const Vec3> positions) const {
    on_behalf_of(body, [&] { bodies[body].check_refit(positions); });
  }

  // Calls find(i, answers) for the i-th pair, on all cores.
  template <class Find>
  void for_near_pairs(std::span<const Sweep::Pair> near, const Find& find) {
    closest_faces.resize(near.size());
    const auto measure = [&](std::size_t begin, std::size_t end) {
      std::unique_ptr<pair::PairAnswers> answers = pool.take();
      for (std::size_t i = begin; i < end; ++i) {
        answers->begin(bodies[near[i][0]], bodies[near[i][1]], hint(near[i]));
        find(i, *answers);
        closest_faces[i] = {near[i], answers->closest_faces()};
      }
      pool.give_back(std::move(answers));
    };
    parallel_for(near.size(), 1, measure);
    std::swap(closest_faces, hints);
  }
  // The faces of a pair that were closest when it was last searched.
  [[nodiscard]] pair::FacePair hint(const Sweep::Pair& pair) const {
    const auto found = std::ranges::lower_bound(hints, pair, {}, &ClosestFaces::pair);
    return found != hints.end() && found->pair == pair ? found->faces : pair::kNoFaces;
  }
  std::span<const Sweep::Pair> near_pairs(double reach) {
    std::ranges::transform(bodies, boxes.begin(), &shape::PosedBody::tight_box);
    return sweep.near_pairs(boxes, reach);
  }

  void find_pairs() {
    const std::span<const Sweep::Pair> near = near_pairs(options.max_distance);
    pairs.resize(near.size());
    for_near_pairs(near, [&](std::size_t i, pair::PairAnswers& answers) {
      if (!answers.within(options.max_distance)) {
        pairs[i].first = kNone;
        return;
      }
      pairs[i] = {.first = near[i][0],
                  .second = near[i][1],
                  .separation = answers.separation(),
                  .colliding = answers.colliding(),
                  .penetration_depth = answers.penetration_depth()};
    });
    std::erase_if(pairs, [](const PairProximity& pair) { return pair.first == kNone; });
    candidates = near.size();
  }

  void find_contacts() {
    const std::span<const Sweep::Pair> near = near_pairs(options.contact_margin);
    if (contacts_of.size() < near.size()) contacts_of.resize(near.size());
    for_near_pairs(near, [&](std::size_t i, pair::PairAnswers& answers) {
      contacts_of[i].clear();
      for (const Contact& contact : answers.contacts())
        contacts_of[i].push_back({near[i][0], near[i][1], contact});
    });
    contacts.clear();
    for (const std::vector<BodyContact>& of_pair : std::span(contacts_of).first(near.size()))
      contacts.insert(contacts.end(), of_pair.begin(), of_pair.end());
  }
};

MultiBodyQuery::MultiBodyQuery(std::vector<Mesh> meshes, const MultiBodyOptions& options)
    : MultiBodyQuery(shapes_of(meshes), checked(options)) {}
MultiBodyQuery::MultiBodyQuery(std::vector<Shape> shapes, const MultiBodyOptions& options) try
    : impl_(std::make_unique<Impl>(std::move(shapes), checked(options))) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("a query of many bodies");
}
MultiBodyQuery::~MultiBodyQuery() = default;
MultiBodyQuery::MultiBodyQuery(MultiBodyQuery&&) noexcept = default;
MultiBodyQuery& MultiBodyQuery::operator=(MultiBodyQuery&&) noexcept = default;

std::size_t MultiBodyQuery::size() const {
  impl_->intact.require();
  return impl_->bodies.size();
}

void MultiBodyQuery::set_pose(std::size_t body, const Transform& pose) {
  on_behalf_of(impl_->checked(body), [&] { impl_->bodies[body].set_pose(pose); });
  impl_->moved();
}

void MultiBodyQuery::set_poses(std::span<const Transform> poses) {
  impl_->check_count(poses.size(), "poses");
  for (std::size_t b = 0; b < size(); ++b)
    on_behalf_of(b, [&] { (void)impl_->bodies[b].checked_pose(poses[b]); });
  for (std::size_t b = 0; b < size(); ++b) impl_->bodies[b].set_pose(poses[b]);
  impl_->moved();
}

Transform MultiBodyQuery::pose(std::size_t body) const {
  return impl_->bodies[impl_->checked(body)].pose().transform();
}

void MultiBodyQuery::refit(std::size_t body, std::span<const Vec3> positions) try {
  const Uncancellable whole;
  impl_->check(impl_->checked(body), positions);
  impl_->moved();
  impl_->intact.change([&] { impl_->bodies[body].refit(positions); });
} catch (const std::bad_alloc&) {
  throw out_of_memory("a query of many bodies");
}

void MultiBodyQuery::refit(std::span<const std::span<const Vec3>> positions) try {
  const Uncancellable whole;
  impl_->check_count(positions.size(), "positions");
  for (std::size_t b = 0; b < size(); ++b)
    if (!positions[b].empty()) impl_->check(b, positions[b]);
  impl_->moved();
  const auto refit = [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      if (!positions[b].empty()) impl_->bodies[b].refit(positions[b]);
  };
  impl_->intact.change([&] { parallel_for(positions.size(), 1, refit); });
} catch (const std::bad_alloc&) {
  throw out_of_memory("a query of many bodies");
}

std::span<const PairProximity> MultiBodyQuery::pairs() try {
  impl_->intact.require();
  if (!impl_->pairs_found) impl_->find_pairs();
  impl_->pairs_found = true;
  return impl_->pairs;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a query of many bodies");
}

std::span<const BodyContact> MultiBodyQuery::contacts() try {
  impl_->intact.require();
  if (!impl_->contacts_found) impl_->find_contacts();
  impl_->contacts_found = true;
  return impl_->contacts;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a query of many bodies");
}

std::size_t MultiBodyQuery::candidate_pairs() const {
  impl_->intact.require();
  return impl_->candidates;
}

NearestMap MultiBodyQuery::nearest_map(std::size_t body) const try {
  NearestMap nearest;
  nearest_map(body, nearest);
  return nearest;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a map of the nearest bodies");
}

void MultiBodyQuery::nearest_map(std::size_t body, NearestMap& nearest) const try {
  on_behalf_of(impl_->checked(body),
               [&] { bodies::map_nearest(impl_->bodies, body, impl_->options.max_distance, nearest); });
} catch (const std::bad_alloc&) {
  throw out_of_memory("a map of the nearest bodies");
}

const Surface& MultiBodyQuery::surface(std::size_t body) const {
  const Surface* surface = nullptr;
  on_behalf_of(impl_->checked(body), [&] { surface = &impl_->bodies[body].body().surface(); });
  return *surface;
}

const Sites& MultiBodyQuery::sites(std::size_t body) const {
  return impl_->bodies[impl_->checked(body)].body().sites();
}

}  // namespace sdm
