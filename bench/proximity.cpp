// Exact separation and collision of two meshes against FCL, in poses that are far, near, touching,
// penetrating and concentric. A repetition is a pose; every result is compared with FCL's before both are
// timed. Searches know nothing of other poses.
//
// Contacts are timed in poses that have some: of ProximityQuery::contacts, with set_pose, against all
// contacts of FCL. The two are not the same: FCL's are the points of every pair of triangles that intersect,
// ours those that a solver needs. Compared is whether there are any, and for bodies that barely intersect
// whether the deepest ones push to the same side (same_side). Also the time of ours in the poses without
// contact.
//
//   build/dev/bench/proximity [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <sdm/proximity_query.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bodies/pairs/pair_search.h"
#include "core/stopwatch.h"
#include "fcl_pair.h"
#include "geometry/vec.h"
#include "harness.h"
#include "mesh/similarity.h"
#include "poses.h"
#include "refine_mesh.h"
#include "scenes.h"
#include "scenes/letters.h"
#include "scenes/reduce_mesh.h"
#include "timing.h"

namespace sdm::bench {
namespace {

constexpr double kShallow = 0.02;  // depth, of the size of both bodies

/// Times in microseconds, one per pose.
struct Times {
  std::vector<double> ours, fcl;

  // The minimum over a few turns: a query is far shorter than the interruptions by other processes.
  void add(const Contender& ours_in_pose, const Contender& fcl_in_pose) {
    constexpr int kTurns = 3;
    constexpr double kLeastMs = 0.1;
    const auto turns = take_turns(std::array{ours_in_pose, fcl_in_pose}, kTurns, kLeastMs);
    ours.push_back(1000 * std::ranges::min(turns[0]));
    fcl.push_back(1000 * std::ranges::min(turns[1]));
  }
};

/// Medians over poses, and the fraction of poses in which ours is faster.
Row row(std::string name, const Times& times) {
  double faster = 0;
  for (std::size_t i = 0; i < times.ours.size(); ++i) faster += times.ours[i] < times.fcl[i];
  const double ours = median(times.ours), fcl = median(times.fcl);
  return {std::move(name),
          {{"ratio", fcl / ours},
           {"ours_us", ours},
           {"fcl_us", fcl},
           {"faster_in", faster / static_cast<double>(times.ours.size())}}};
}

/// Of poses with contacts.
struct ContactTimes : Times {
  std::vector<double> our_count, fcl_count;

  void count(std::size_t our_contacts, std::size_t fcl_contacts) {
    our_count.push_back(static_cast<double>(our_contacts));
    fcl_count.push_back(static_cast<double>(fcl_contacts));
  }
};

Row row(std::string name, const ContactTimes& times) {
  if (times.ours.empty()) return {std::move(name), {{"poses", 0}}};
  Row result = row(std::move(name), static_cast<const Times&>(times));
  result.figures.insert(result.figures.end(), {{"ours", median(times.our_count)},
                                               {"fcl", median(times.fcl_count)},
                                               {"poses", static_cast<double>(times.ours.size())}});
  return result;
}

Outcome measure(const Trial& trial, const std::array<Mesh, 2>& meshes) {
  const auto& [m1, m2] = meshes;
  const Sites o1(m1), o2(m2);
  const FclPair fcl(m1, m2);
  const double size = diagonal(bounds(m1)) + diagonal(bounds(m2));
  std::mt19937 random(1);
  const sites::CylinderTree cylinders1(internals(o1).wide, internals(o1).regions),
      cylinders2(internals(o2).wide, internals(o2).regions);
  pairs::PairWorkspace workspace;
  Times separation, collision;
  ProximityQuery query(m1, m2);
  std::vector<double> no_contacts;
  ContactTimes shallow, deep;
  std::vector<double> same_side;
  std::size_t wrong = 0;
  for (const Affine& pose : random_poses(o1, o2, static_cast<std::size_t>(trial.repetitions), random)) {
    const pairs::MeshPair posed{internals(o1), internals(o2), pose, {&cylinders1, &cylinders2}};
    const auto separate = [&] { return pairs::find_closest(posed, 10 * size, workspace); };
    const auto collide = [&] { return pairs::find_intersection(posed, workspace).intersecting; };
    // FCL returns -1 for surfaces that intersect, and rounds transformed vertices differently: for surfaces
    // that just touch, it may return either.
    const pairs::Separation found = separate();
    const bool same_distance = std::abs(found.distance - std::max(0.0, fcl.distance(pose))) <= 1e-6 * size;
    const bool same_verdict = collide() == fcl.collide(pose) || found.distance < 1e-12 * size;
    wrong += !same_distance || !same_verdict || collide() != found.intersecting;
    const auto contender = [&](const std::function<void()>& work) { return Contender{work, trial.threads}; };
    separation.add(contender([&] { (void)separate(); }), contender([&] { (void)fcl.distance(pose); }));
    collision.add(contender([&] { (void)collide(); }), contender([&] { (void)fcl.collide(pose); }));
    const auto find_contacts = [&] {
      query.set_pose(1, mesh::Similarity{.map = pose}.transform());
      return query.contacts();
    };
    const FclPair::Contacts theirs = fcl.contacts(pose);
    if (const std::span<const Contact> contacts = find_contacts(); !contacts.empty()) {
      wrong += !query.colliding();
      const bool is_shallow = contacts[0].depth < kShallow * size;
      if (is_shallow && theirs.count > 0)
        same_side.push_back(dot(contacts[0].normal, theirs.deepest_normal) < 0);
      ContactTimes& times = is_shallow ? shallow : deep;
      times.count(contacts.size(), theirs.count);
      times.add(contender([&] { (void)find_contacts(); }), contender([&] { (void)fcl.contacts(pose); }));
    } else {
      // Surfaces that just touch may have contacts or not.
      wrong += theirs.count > 0 && query.colliding() && query.penetration_depth() &&
               query.penetration_depth()->lower > 1e-9 * size;
      Stopwatch watch;
      constexpr int kTimes = 20;
      for (int i = 0; i < kTimes; ++i) (void)find_contacts();
      no_contacts.push_back(1000 * watch.lap() / kTimes);
    }
  }
  if (wrong > 0) std::fprintf(stderr, "%zu of %d poses differ from FCL's\n", wrong, trial.repetitions);
  return {
      .verified = wrong == 0,
      .rows = {row("separation", separation),
               row("collision", collision),
               row("contacts, shallow", shallow),
               row("contacts, deep", deep),
               {"deepest contacts", {{"same_side", mean(same_side)}}},
               {"no contacts", {{"ours_us", median(no_contacts)}, {"p99_us", quantile(no_contacts, 0.99)}}}}};
}

std::vector<Case> cases() {
  const auto bunny = [] { return load("bunny.obj", "fit"); };
  const auto armadillo = [] { return load("armadillo.off", "fit"); };
  std::vector<Case> result;
  const auto add = [&](std::string name, std::string what,
                       const std::function<std::array<Mesh, 2>()>& meshes) {
    result.push_back({.name = std::move(name),
                      .description = std::move(what),
                      .run = [meshes](const Trial& trial) { return measure(trial, meshes()); },
                      .repetitions = 200});
  };
  add("letters", "E and G, 2.1k and 1.6k triangles", [] {
    return std::array{scenes::letter_e(), scenes::letter_g()};
  });
  add("bunnies", "two bunnies of 2k", [=] {
    return std::array{scenes::reduce_mesh(bunny(), 2000), scenes::reduce_mesh(bunny(), 2000)};
  });
  add("bunny-armadillo-5k", "5k each", [=] {
    return std::array{scenes::reduce_mesh(bunny(), 5000), scenes::reduce_mesh(armadillo(), 5000)};
  });
  add("figure-letter", "17.2k and 2.1k", [] { return std::array{paper_figure(), scenes::letter_e()}; });
  add("figure-box", "17.2k, and a box of 12 larger than it", [] {
    return std::array{paper_figure(), paper_box(paper_figure())};
  });
  add("bunny-armadillo", "70k and 52k", [=] { return std::array{bunny(), armadillo()}; });
  add("refined", "the same with twice the edges, 279k and 208k", [=] {
    return std::array{refine_mesh(bunny(), 2, 0), refine_mesh(armadillo(), 2, 0)};
  });
  return result;
}

}  // namespace

Program program() {
  return {.name = "proximity",
          .description = "Exact separation, collision and contacts against FCL",
          .repetition = "poses",
          .cases = cases()};
}

}  // namespace sdm::bench
