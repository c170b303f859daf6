// Queries of two bodies against Coal 3 (https://github.com/coal-library/coal), which is no part of this
// project: configure with -DSDM_COAL=PREFIX, that of its headers and library; of its wheel,
// site-packages/cmeel.prefix. Both set the pose of the second body, and compute on one core. A repetition is
// a turn of all poses of a row.
//
//   build/dev/bench/coal [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <sdm/mesh_edit.h>
#include <sdm/proximity_query.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "coal_pair.h"
#include "geometry/vec.h"
#include "harness.h"
#include "mesh/similarity.h"
#include "poses.h"
#include "refine_mesh.h"
#include "scenes.h"
#include "scenes/ball.h"
#include "scenes/box_mesh.h"
#include "timing.h"

namespace sdm::bench {
namespace {

struct Subject {
  std::string name;
  Shape shape;
  CoalShape peer;
  double size;  // the largest extent
};

enum class Place { far, near, overlapping };

std::string name_of(Place place) {
  return place == Place::far ? "far" : place == Place::near ? "near" : "overlapping";
}

/// Whether poses follow each other, as in a simulation, or have nothing in common.
enum class Course { frames, random };

Transform random_turn(std::mt19937& random) {
  return mesh::Similarity{.map = random_rotation(random)}.transform();
}

// A pose of O2 in a random direction from O1: two sizes from touching, 0.01 of it, or 0.1 into O1.
Transform random_pose(const Subject& o1, const Subject& o2, Place place, std::mt19937& random) {
  const double size = 0.5 * (o1.size + o2.size);
  ProximityQuery query(o1.shape, o2.shape);
  const Transform turn = random_turn(random);
  const Vec3 away = o1.name == "half-space" ? Vec3{0, 0, 1} : random_rotation(random).rows[0];
  const auto pose_at = [&](double distance) { return Transform::translation(distance * away) * turn; };
  double at = 4 * size;
  for (int step = 0; step < 60; ++step) {
    query.set_pose(1, pose_at(at));
    const double free = query.separation().value;
    if (free < 1e-9 * size || query.colliding()) break;
    at -= free;
  }
  return pose_at(at + (place == Place::far ? 2 : place == Place::near ? 0.01 : -0.1) * size);
}

// 100 poses: of 5 starts, 20 each that turn by 0.1° and move by 0.0005 of the size a frame, or all random.
std::vector<Transform> poses_of(const Subject& o1, const Subject& o2, Place place, Course course,
                                std::mt19937& random) {
  constexpr int kStarts = 5, kFrames = 20;
  constexpr double kTurn = 0.1, kSlide = 0.0005;
  std::vector<Transform> poses;
  for (int start = 0; start < kStarts; ++start) {
    Transform pose = random_pose(o1, o2, place, random);
    const Vec3 slide = kSlide * 0.5 * (o1.size + o2.size) * random_rotation(random).rows[0];
    const Vec3 turn = kTurn * random_rotation(random).rows[0];
    for (int frame = 0; frame < kFrames; ++frame) {
      if (course == Course::random) pose = random_pose(o1, o2, place, random);
      poses.push_back(pose);
      pose = Transform::translation(slide) * pose * Transform::rotation(turn);
    }
  }
  return poses;
}

struct Question {
  std::string name;
  std::function<double(ProximityQuery&)> ours;
  std::function<double(const CoalPair&, std::size_t)> theirs;
  /// Whether the answers of a pose agree, of bodies of this size.
  std::function<bool(double, double, double)> agree;
};

// Coal's tolerance of distances and depths is 1e-6.
bool near_each_other(double ours, double theirs, double size) {
  return std::abs(ours - theirs) <= 2e-5 * size;
}

Question distance_question() {
  return {"distance", [](ProximityQuery& query) { return query.colliding() ? 0 : query.separation().value; },
          [](const CoalPair& pair, std::size_t pose) { return std::max(0.0, pair.distance(pose)); },
          near_each_other};
}

// Of bodies that overlap, ours also finds whether their surfaces intersect, and where.
Question separation_question() {
  Question question = distance_question();
  question.name = "separation";
  question.ours = [](ProximityQuery& query) { return query.separation().value; };
  return question;
}

Question way_out_question() {
  return {"way out", [](ProximityQuery& query) { return -query.separating_translation().value; },
          [](const CoalPair& pair, std::size_t pose) { return pair.signed_distance(pose); },
          [](double ours, double theirs, double size) {  // Coal's may not be the shortest
            return theirs <= ours + 2e-5 * size;
          }};
}

Question collision_question() {
  return {"collision", [](ProximityQuery& query) { return query.colliding() ? 1 : 0; },
          [](const CoalPair& pair, std::size_t pose) { return pair.collide(pose) ? 1 : 0; },
          [](double ours, double theirs, double) { return ours == theirs; }};
}

Outcome measure(const Trial& trial, const Subject& o1, const Subject& o2, bool meshes) {
  Outcome outcome{.verified = true};
  std::mt19937 random(1);
  for (const Place place : {Place::far, Place::near, Place::overlapping})
    for (const Course course : {Course::frames, Course::random}) {
      const std::vector<Transform> poses = poses_of(o1, o2, place, course, random);
      const CoalPair theirs(o1.peer, o2.peer, poses, course == Course::frames);
      ProximityQuery ours(o1.shape, o2.shape);
      std::vector<Question> questions{collision_question()};
      if (place == Place::overlapping && !meshes)
        questions.insert(questions.end(), {distance_question(), way_out_question()});
      questions.push_back(separation_question());
      for (const Question& question : questions) {
        const std::string name =
            question.name + ", " + name_of(place) + (course == Course::frames ? ", frames" : ", random");
        for (std::size_t i = 0; i < poses.size(); ++i) {
          ours.set_pose(1, poses[i]);
          const double our = question.ours(ours), their = question.theirs(theirs, i);
          const bool agrees = question.agree(our, their, 0.5 * (o1.size + o2.size));
          if (!agrees) std::fprintf(stderr, "%s: %.9g, Coal %.9g\n", name.c_str(), our, their);
          outcome.verified = outcome.verified && agrees;
        }
        const Contender we{[&] {
                             for (const Transform& pose : poses) {
                               ours.set_pose(1, pose);
                               (void)question.ours(ours);
                             }
                           },
                           trial.threads};
        const Contender they{[&] {
                               for (std::size_t i = 0; i < poses.size(); ++i)
                                 (void)question.theirs(theirs, i);
                             },
                             trial.threads};
        const auto times = take_turns(std::array{we, they}, trial.repetitions, 1);
        // The least time of a turn: others contain interruptions by other processes.
        const double per_pose = 1000 / static_cast<double>(poses.size());
        const double our_us = per_pose * std::ranges::min(times[0]),
                     coal_us = per_pose * std::ranges::min(times[1]);
        outcome.rows.push_back(
            {name, {{"ratio", coal_us / our_us}, {"ours_us", our_us}, {"coal_us", coal_us}}});
      }
    }
  return outcome;
}

Subject hull(int cuts, const Vec3& half) {
  Mesh mesh = scenes::ball({}, 1, cuts);
  for (Vec3& p : mesh.positions)
    for (int k = 0; k < 3; ++k) p[k] *= half[k];
  mesh = convex_hull(mesh);
  return {"hull", Shape(mesh), coal_hull(mesh), 2 * std::max({half[0], half[1], half[2]})};
}

Subject of_mesh(const Mesh& mesh) {
  return {"mesh", Shape(mesh), coal_mesh(mesh), 1};
}

std::vector<Subject> primitives() {
  return {{"half-space", Shape::half_space({0, 0, 1}), coal_half_space({0, 0, 1}, 0), 1},
          {"sphere", Shape::sphere(0.5), coal_sphere(0.5), 1},
          {"capsule", Shape::capsule(0.3, 0.8), coal_capsule(0.3, 0.8), 1},
          {"cylinder", Shape::cylinder(0.4, 1), coal_cylinder(0.4, 1), 1},
          {"box", Shape::box({1, 0.7, 0.5}), coal_box({1, 0.7, 0.5}), 1}};
}

std::vector<Case> cases() {
  std::vector<Case> result;
  const auto add = [&](std::string name, std::string what, bool meshes,
                       const std::function<std::array<Subject, 2>()>& subjects) {
    result.push_back({.name = std::move(name),
                      .description = std::move(what),
                      .run =
                          [subjects, meshes](const Trial& trial) {
                            const auto [o1, o2] = subjects();
                            return measure(trial, o1, o2, meshes);
                          },
                      .repetitions = 15});
  };
  const Vec3 half1{1, 0.7, 0.5}, half2{0.6, 0.9, 0.8};
  add("hulls-12", "boxes as hulls", false, [=] {
    const auto box = [](const Vec3& half) {
      const Mesh mesh = scenes::box_mesh({-half, half});
      return Subject{"box", Shape(mesh), coal_hull(mesh), 2 * std::max({half[0], half[1], half[2]})};
    };
    return std::array{box(half1), box(half2)};
  });
  for (int cuts = 1; cuts <= 4; ++cuts)
    add("hulls-" + std::to_string(8 << (2 * cuts)), "hulls of ellipsoids", false, [=] {
      return std::array{hull(cuts, half1), hull(cuts, half2)};
    });
  add("head-man", "meshes of 3k and 35k triangles", true, [] {
    return std::array{of_mesh(load("head.off", "fit")), of_mesh(load("man.off", "fit"))};
  });
  add("bunny-armadillo", "70k and 52k", true, [] {
    return std::array{of_mesh(load("bunny.obj", "fit")), of_mesh(load("armadillo.off", "fit"))};
  });
  const std::vector<Subject> all = primitives();
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = std::max<std::size_t>(i, 1); j < all.size(); ++j)
      add(all[i].name + "-" + all[j].name, "primitives", false, [i, j] {
        return std::array{primitives()[i], primitives()[j]};
      });
  return result;
}

}  // namespace

Program program() {
  return {.name = "coal",
          .description = "Distances and collisions of two bodies against Coal",
          .repetition = "turns",
          .cases = cases()};
}

}  // namespace sdm::bench
