#include <sdm/error.h>
#include <sdm/multi_body_query.h>

#include <algorithm>
#include <functional>
#include <mutex>
#include <new>
#include <string>
#include <utility>

#include "core/geometry/sweep.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "mesh/validate.h"
#include "proximity/bodies/nearest_body.h"
#include "proximity/sampled/body.h"
#include "proximity/sampled/pair_answers.h"

namespace sdm {
namespace {

const MultiBodyOptions& checked(const MultiBodyOptions& options) {
  if (!(options.max_distance > 0)) throw Error("the maximum distance must be greater than 0");
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

// A pool of the memory for pairs measured concurrently: one entry for each thread.
class AnswersPool {
 public:
  explicit AnswersPool(const sampled::PairAnswers::Options& options) : options_(options) {}

  std::unique_ptr<sampled::PairAnswers> take() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return std::make_unique<sampled::PairAnswers>(options_);
    std::unique_ptr<sampled::PairAnswers> answers = std::move(idle_.back());
    idle_.pop_back();
    return answers;
  }
  void give_back(std::unique_ptr<sampled::PairAnswers> answers) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(answers));
  }

 private:
  sampled::PairAnswers::Options options_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<sampled::PairAnswers>> idle_;
};

}  // namespace

struct MultiBodyQuery::Impl {
  MultiBodyOptions options;
  std::vector<sampled::Body> bodies;
  AnswersPool pool;
  Sweep sweep;
  std::vector<Box> boxes;

  // Results since the last refit.
  bool found = false;
  std::size_t candidates = 0;
  std::vector<PairProximity> pairs;

  Impl(std::span<const Mesh> meshes, const MultiBodyOptions& asked)
      : options(asked), pool({.exact = asked.exact}), boxes(meshes.size()) {
    bodies.reserve(meshes.size());
    for (const Mesh& mesh : meshes)
      on_behalf_of(bodies.size(), [&] { bodies.emplace_back(mesh, options.atlas); });
  }

  [[nodiscard]] std::size_t checked(std::size_t body) const {
    if (body >= bodies.size())
      throw Error("there is no body " + std::to_string(body) + " among " + std::to_string(bodies.size()) +
                  "; they are numbered from 0");
    return body;
  }
  void check(std::size_t body, std::span<const Vec3> positions) const {
    on_behalf_of(
        body, [&] { mesh::validate_positions(positions, bodies[body].surface().mesh().positions.size()); });
  }

  void find_pairs() {
    std::ranges::transform(bodies, boxes.begin(), &sampled::Body::box);
    const std::span<const Sweep::Pair> near = sweep.near_pairs(boxes, options.max_distance);
    candidates = near.size();
    pairs.resize(near.size());
    const auto measure = [&](std::size_t begin, std::size_t end) {
      std::unique_ptr<sampled::PairAnswers> answers = pool.take();
      for (std::size_t i = begin; i < end; ++i) {
        const auto [a, b] = near[i];
        answers->begin(bodies[a], bodies[b]);
        pairs[i] = {.first = a,
                    .second = b,
                    .separation = answers->separation(),
                    .colliding = answers->colliding(),
                    .penetration_depth = answers->penetration_depth()};
      }
      pool.give_back(std::move(answers));
    };
    parallel_for(near.size(), 1, measure);
    std::erase_if(pairs, [&](const PairProximity& pair) {
      return pair.separation.lower > options.max_distance && !pair.colliding.value;
    });
  }
};

MultiBodyQuery::MultiBodyQuery(std::vector<Mesh> meshes, const MultiBodyOptions& options) try
    : impl_(std::make_unique<Impl>(meshes, checked(options))) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("a query of many bodies");
}
MultiBodyQuery::~MultiBodyQuery() = default;
MultiBodyQuery::MultiBodyQuery(MultiBodyQuery&&) noexcept = default;
MultiBodyQuery& MultiBodyQuery::operator=(MultiBodyQuery&&) noexcept = default;

std::size_t MultiBodyQuery::size() const {
  return impl_->bodies.size();
}

void MultiBodyQuery::refit(std::size_t body, std::span<const Vec3> positions) try {
  impl_->check(impl_->checked(body), positions);
  impl_->found = false;
  impl_->bodies[body].refit(positions);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a query of many bodies");
}

void MultiBodyQuery::refit(std::span<const std::span<const Vec3>> positions) try {
  if (positions.size() != size())
    throw Error("there are " + std::to_string(size()) + " bodies, but positions for " +
                std::to_string(positions.size()) + " were given; give one entry per body");
  for (std::size_t b = 0; b < size(); ++b)
    if (!positions[b].empty()) impl_->check(b, positions[b]);
  impl_->found = false;
  const auto refit = [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      if (!positions[b].empty()) impl_->bodies[b].refit(positions[b]);
  };
  parallel_for(size(), 1, refit);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a query of many bodies");
}

std::span<const PairProximity> MultiBodyQuery::pairs() try {
  if (!impl_->found) impl_->find_pairs();
  impl_->found = true;
  return impl_->pairs;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a query of many bodies");
}

std::size_t MultiBodyQuery::candidate_pairs() const {
  return impl_->candidates;
}

NearestMap MultiBodyQuery::nearest_map(std::size_t body) const {
  NearestMap nearest;
  nearest_map(body, nearest);
  return nearest;
}

void MultiBodyQuery::nearest_map(std::size_t body, NearestMap& nearest) const try {
  bodies::map_nearest(impl_->bodies, impl_->checked(body), impl_->options.max_distance, nearest);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a map of the nearest bodies");
}

const Surface& MultiBodyQuery::surface(std::size_t body) const {
  return impl_->bodies[impl_->checked(body)].surface();
}

const Sites& MultiBodyQuery::sites(std::size_t body) const {
  return impl_->bodies[impl_->checked(body)].sites();
}

}  // namespace sdm
