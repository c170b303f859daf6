#include <sdm/error.h>
#include <sdm/proximity_query.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <string>
#include <utility>

#include "bodies/convex/pose_packet.h"
#include "bodies/many/pool.h"
#include "bodies/pair/pair_answers.h"
#include "bodies/shape/posed_body.h"
#include "core/memory.h"
#include "core/parallel.h"

namespace sdm {
namespace {

// The shape in one pose after another; each thread has one of its own.
class PosedShape {
 public:
  PosedShape(const Shape& shape, std::size_t obstacles, const std::optional<double>& depth_precision)
      : body_(shape), answers_(0, depth_precision), hints_(obstacles) {}

  // A pose, and what moved since the last one.
  void begin(const Transform& pose) { body_.set_pose(pose); }

  // The obstacle that was hit last is likely to be hit again.
  bool colliding(std::span<const shape::PosedBody> obstacles) {
    if (last_hit_ < obstacles.size() && hits(obstacles, last_hit_)) return true;
    for (std::size_t i = 0; i < obstacles.size(); ++i)
      if (i != last_hit_ && hits(obstacles, i)) {
        last_hit_ = i;
        return true;
      }
    return false;
  }

  double separation(std::span<const shape::PosedBody> obstacles, double max_distance) {
    double least = kInfinity;
    for (std::size_t i = 0; i < obstacles.size() && least > 0; ++i) {
      answers_.begin(body_, obstacles[i], hints_[i]);
      if (answers_.surfaces_within(std::min(max_distance, least)))
        least = std::min(least, answers_.separation().value);
      hints_[i] = answers_.known().hints();
    }
    return least;
  }

  BoundedNumber depth(std::span<const shape::PosedBody> obstacles) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    BoundedNumber largest{.value = kNan, .certainty = Certainty::exact, .lower = kNan, .upper = kNan};
    for (const shape::PosedBody& obstacle : obstacles) {
      answers_.begin(body_, obstacle);
      const std::optional<BoundedLength>& depth = answers_.penetration_depth();
      if (!depth) continue;
      largest.value = std::fmax(largest.value, depth->value);
      largest.lower = std::fmax(largest.lower, depth->lower);
      largest.upper = std::fmax(largest.upper, depth->upper);
      if (depth->certainty != Certainty::exact) largest.certainty = depth->certainty;
    }
    return largest;
  }

 private:
  bool hits(std::span<const shape::PosedBody> obstacles, std::size_t i) {
    answers_.begin(body_, obstacles[i], hints_[i]);
    const bool colliding = answers_.colliding();
    hints_[i] = answers_.known().hints();
    return colliding;
  }

  shape::PosedBody body_;
  pair::PairAnswers answers_;
  std::vector<pair::Hints> hints_;  // of the last pose, for each obstacle
  std::size_t last_hit_ = 0;
};

// Calls `work`, whose errors of memory become sdm::Error.
template <class Work>
decltype(auto) with_memory_of_poses(const Work& work) try {
  return work();
} catch (const std::bad_alloc&) {
  throw out_of_memory("a query of many poses");
}

// Errors name the pose.
void begin_pose(PosedShape& posed, std::span<const Transform> poses, std::size_t i) {
  try {
    posed.begin(poses[i]);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    throw Error("pose " + std::to_string(i) + ": " + error.what(), error.remedy());
  }
}

// The relation of a body to all obstacles: overlap if one of them does, apart if all are, otherwise unknown.
using Relations = std::array<convex::Relation, convex::PosePacket::kPoses>;
Relations relations_to_all(std::span<const std::optional<convex::PosePacket>> packets,
                           std::span<const Transform> poses) {
  using enum convex::Relation;
  Relations all, one;
  all.fill(packets.empty() ? unknown : apart);
  for (const std::optional<convex::PosePacket>& packet : packets) {
    one.fill(unknown);
    if (packet) packet->decide(poses, std::span(one).first(poses.size()));
    for (std::size_t i = 0; i < poses.size(); ++i)
      if (all[i] != overlap && one[i] != apart) all[i] = one[i];
  }
  return all;
}

const PoseQueryOptions& checked(const PoseQueryOptions& options) {
  check_options(options);
  return options;
}

}  // namespace

struct PoseQuery::Impl {
  Shape shape;
  std::vector<shape::PosedBody> obstacles;
  PoseQueryOptions options;
  bodies::Pool<PosedShape> pool;
  std::vector<std::optional<convex::PosePacket>> packets;

  Impl(Shape of, std::vector<Shape> others, const PoseQueryOptions& asked)
      : shape(std::move(of)), options(asked) {
    obstacles.reserve(others.size());
    for (Shape& other : others) obstacles.emplace_back(std::move(other));
  }

  // The packets that decide collisions with the obstacles; none of bodies that are not convex.
  const std::vector<std::optional<convex::PosePacket>>& make_packets() {
    packets.resize(obstacles.size());
    const convex::ConvexMesh* const moving = internals(shape)->convex();
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      packets[i].reset();
      const convex::ConvexMesh* const resting = obstacles[i].body().convex();
      if (moving != nullptr && resting != nullptr) packets[i].emplace(*moving, *resting, obstacles[i].pose());
    }
    return packets;
  }

  // find_some(posed shape, begin, end) for ranges of poses, on all cores.
  template <class Result, class FindSome>
  void for_ranges(std::span<const Transform> poses, std::span<Result> results, std::size_t grain,
                  const FindSome& find_some) {
    if (results.size() != poses.size())
      throw Error("there are " + std::to_string(poses.size()) + " poses, but room for " +
                  std::to_string(results.size()) + " results; give one for each pose");
    const auto take_and_find = [&](std::size_t begin, std::size_t end) {
      std::unique_ptr<PosedShape> posed = pool.take(
          [&] { return std::make_unique<PosedShape>(shape, obstacles.size(), options.depth_precision); });
      find_some(*posed, begin, end);
      pool.give_back(std::move(posed));
    };
    with_memory_of_poses([&] { parallel_for(poses.size(), grain, take_and_find); });
  }
  // results[i] = find(shape in poses[i]), on all cores.
  template <class Result, class Find>
  void for_each(std::span<const Transform> poses, std::span<Result> results, const Find& find) {
    constexpr std::size_t kGrain = 8;
    for_ranges(poses, results, kGrain, [&](PosedShape& posed, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        begin_pose(posed, poses, i);
        results[i] = find(posed);
      }
    });
  }
};

PoseQuery::PoseQuery(Shape shape, std::vector<Shape> obstacles, const PoseQueryOptions& options)
    : impl_(with_memory_of_poses([&] {
        return std::make_unique<Impl>(std::move(shape), std::move(obstacles), checked(options));
      })) {}
PoseQuery::PoseQuery(Shape shape, Shape obstacle, const PoseQueryOptions& options)
    : PoseQuery(std::move(shape), with_memory_of_poses([&] { return std::vector{std::move(obstacle)}; }),
                options) {}
PoseQuery::~PoseQuery() = default;
PoseQuery::PoseQuery(PoseQuery&&) noexcept = default;
PoseQuery& PoseQuery::operator=(PoseQuery&&) noexcept = default;

void PoseQuery::set_pose(std::size_t obstacle, const Transform& pose) {
  if (obstacle >= impl_->obstacles.size())
    throw Error("there is no obstacle " + std::to_string(obstacle) + " among " +
                std::to_string(impl_->obstacles.size()) + "; they are numbered from 0");
  impl_->obstacles[obstacle].set_pose(pose);
}

std::vector<std::uint8_t> PoseQuery::colliding(std::span<const Transform> poses) {
  auto results = with_memory_of_poses([&] { return std::vector<std::uint8_t>(poses.size()); });
  colliding(poses, results);
  return results;
}

void PoseQuery::colliding(std::span<const Transform> poses, std::span<std::uint8_t> results) {
  constexpr std::size_t kPacket = convex::PosePacket::kPoses;
  const auto& packets = with_memory_of_poses([&]() -> const auto& { return impl_->make_packets(); });
  impl_->for_ranges(poses, results, kPacket, [&](PosedShape& posed, std::size_t begin, std::size_t end) {
    for (std::size_t first = begin; first < end; first += kPacket) {
      const std::size_t last = std::min(end, first + kPacket);
      const Relations known = relations_to_all(packets, poses.subspan(first, last - first));
      for (std::size_t i = first; i < last; ++i) {
        const convex::Relation relation = known[i - first];
        if (relation == convex::Relation::unknown) {
          begin_pose(posed, poses, i);
          results[i] = posed.colliding(impl_->obstacles) ? 1 : 0;
        } else {
          results[i] = relation == convex::Relation::overlap ? 1 : 0;
        }
      }
    }
  });
}

std::vector<double> PoseQuery::separations(std::span<const Transform> poses, double max_distance) {
  auto results = with_memory_of_poses([&] { return std::vector<double>(poses.size()); });
  separations(poses, max_distance, results);
  return results;
}

void PoseQuery::separations(std::span<const Transform> poses, double max_distance,
                            std::span<double> results) {
  if (!(max_distance > 0)) throw Error("the maximum distance must be greater than 0");
  impl_->for_each(poses, results,
                  [&](PosedShape& posed) { return posed.separation(impl_->obstacles, max_distance); });
}

std::vector<BoundedNumber> PoseQuery::penetration_depths(std::span<const Transform> poses) {
  auto results = with_memory_of_poses([&] { return std::vector<BoundedNumber>(poses.size()); });
  penetration_depths(poses, results);
  return results;
}

void PoseQuery::penetration_depths(std::span<const Transform> poses, std::span<BoundedNumber> results) {
  impl_->for_each(poses, results, [&](PosedShape& posed) { return posed.depth(impl_->obstacles); });
}

}  // namespace sdm
