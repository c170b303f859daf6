// Times queries of two meshes in random poses, and writes meshes, poses and results for other libraries, for
// bench/peers.
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "arrays.h"
#include "core/stopwatch.h"
#include "geometry/vec.h"
#include "mesh/similarity.h"
#include "poses.h"
#include "refine_mesh.h"
#include "samples.h"
#include "scenes.h"
#include "scenes/ball.h"
#include "scenes/box_mesh.h"

namespace sdm::bench {
namespace {

// A mesh of the benchmarks; "box", or "hull:N", the hull of an ellipsoid that is subdivided N times.
Mesh mesh_of(const std::string& name, std::uint32_t parts, const Vec3& half) {
  if (name == "box") return scenes::box_mesh({-half, half});
  if (!name.starts_with("hull:")) return refine_mesh(load(name, "fit"), parts, 0);
  Mesh mesh = scenes::ball({}, 1, std::stoi(name.substr(5)));
  for (Vec3& p : mesh.positions)
    for (int k = 0; k < 3; ++k) p[k] *= half[k];
  return convex_hull(mesh);
}

constexpr std::size_t kRandomPoses = 2000;

// Random rotations, with offsets in a cube about the origin.
std::vector<Affine> poses_within(double reach, std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> offset(-reach, reach);
  std::vector<Affine> poses;
  while (poses.size() < count) {
    Affine& pose = poses.emplace_back(random_rotation(random));
    for (double& x : pose.offset) x = offset(random);
  }
  return poses;
}

// 3 × 4 for each, by rows.
std::vector<double> entries_of(const std::vector<Affine>& poses) {
  std::vector<double> entries;
  for (const Affine& pose : poses)
    for (std::size_t row = 0; row < 3; ++row) {
      entries.insert(entries.end(), pose.rows[row].begin(), pose.rows[row].end());
      entries.push_back(pose.offset[row]);
    }
  return entries;
}

// Microseconds for each pose, of all in one call.
double time_batch(PoseQuery& query, const std::vector<Transform>& poses,
                  const std::vector<std::uint8_t>& expected) {
  Stopwatch watch;
  const std::vector<std::uint8_t> found = query.colliding(poses);
  const double us = 1000 * watch.lap() / static_cast<double>(poses.size());
  if (found != expected) throw std::runtime_error("poses in one call have other collisions than single ones");
  return us;
}

struct PoseSamples {
  std::string o1, o2;
  std::filesystem::path out;
  std::uint32_t parts = 1, count = 200;
};

void write_pose_samples(const PoseSamples& options) {
  const auto& [o1, o2, out, parts, count] = options;

  const Mesh m1 = mesh_of(o1, parts, {1, 0.7, 0.5}), m2 = mesh_of(o2, parts, {0.6, 0.9, 0.8});
  std::mt19937 random(1);
  const std::vector<Affine> placements = random_poses(Sites(m1), Sites(m2), count, random);
  ProximityQuery query(m1, m2);
  std::vector<double> separation(count), separation_us(count, kInfinity), colliding_us(count, kInfinity),
      contacts_us(count, kInfinity), contacts_all_us(count, kInfinity),
      separating_contacts_us(count, kInfinity);
  std::vector<std::uint8_t> colliding(count);
  std::vector<std::uint32_t> contacts(count), separating_contacts(count);
  std::vector<Vec3> translation(count);
  // Every pose follows another one, as in use: what the last pose leaves is no help.
  constexpr int kTurns = 3;
  const auto time = [&](std::vector<double>& best, const auto& answer) {
    for (std::size_t i = 0; i < count; ++i) {
      Stopwatch watch;
      query.set_pose(1, mesh::Similarity{.map = placements[i]}.transform());
      answer(i);
      best[i] = std::min(best[i], 1000 * watch.lap());
    }
  };
  const auto find_contacts = [&](std::size_t i) {
    contacts[i] = static_cast<std::uint32_t>(query.contacts().size());
  };
  // Of others, the search for a translation takes thousands of times as long.
  const bool convex = Shape(m1).convex() && Shape(m2).convex();
  for (int turn = 0; turn < kTurns; ++turn) {
    time(contacts_all_us, find_contacts);
    const ThreadLimit alone(1);
    time(separation_us, [&](std::size_t i) { separation[i] = query.separation().value; });
    time(colliding_us, [&](std::size_t i) { colliding[i] = query.colliding(); });
    time(contacts_us, find_contacts);
    if (!convex) continue;
    time(separating_contacts_us, [&](std::size_t i) {
      separating_contacts[i] = static_cast<std::uint32_t>(query.separating_contacts(4).size());
    });
  }
  if (convex)
    for (std::size_t i = 0; i < count; ++i) {
      query.set_pose(1, mesh::Similarity{.map = placements[i]}.transform());
      translation[i] = query.separating_translation().translation;
    }
  Stopwatch clock;
  std::vector<double> clock_us(1, kInfinity);  // what the times contain of the clock
  for (std::uint32_t i = 0; i < count; ++i) clock_us[0] = std::min(clock_us[0], 1000 * clock.lap());
  write_array<double>(out / "clock_us", clock_us);
  PoseQuery many{Shape(m2), Shape(m1)};
  std::vector<Transform> transforms;
  for (const Affine& placement : placements)
    transforms.push_back(mesh::Similarity{.map = placement}.transform());
  // As each body is compared in the frame of O1, surfaces that just touch may have another answer if they are
  // exchanged.
  ProximityQuery exchanged(m2, m1);
  std::vector<std::uint8_t> expected;
  for (const Transform& pose : transforms) {
    exchanged.set_pose(0, pose);
    expected.push_back(exchanged.colliding());
  }
  const auto time_batches = [&](const char* file, const std::vector<Transform>& batch,
                                const std::vector<std::uint8_t>& hits) {
    std::vector<double> batch_us(2, kInfinity);
    for (int turn = 0; turn < kTurns; ++turn) {
      batch_us[1] = std::min(batch_us[1], time_batch(many, batch, hits));
      const ThreadLimit alone(1);
      batch_us[0] = std::min(batch_us[0], time_batch(many, batch, hits));
    }
    write_array<double>(out / file, batch_us);
  };
  time_batches("batch_us", transforms, expected);
  if (convex) {
    const double reach = 0.3 * (diagonal(bounds(m1)) + diagonal(bounds(m2)));
    const std::vector<Affine> places = poses_within(reach, kRandomPoses, random);
    std::vector<Transform> batch;
    std::vector<std::uint8_t> hits;
    for (const Affine& place : places) {
      batch.push_back(mesh::Similarity{.map = place}.transform());
      exchanged.set_pose(0, batch.back());
      hits.push_back(exchanged.colliding());
    }
    time_batches("random_us", batch, hits);
    write_array<double>(out / "random_poses", entries_of(places));
    write_array<std::uint8_t>(out / "random_colliding", hits);
  }
  write_array<Vec3>(out / "vertices1", m1.positions);
  write_array<Vec3>(out / "vertices2", m2.positions);
  write_array<Triangle>(out / "triangles1", m1.triangles);
  write_array<Triangle>(out / "triangles2", m2.triangles);
  write_array<double>(out / "poses", entries_of(placements));
  write_array<double>(out / "separation", separation);
  write_array<double>(out / "separation_us", separation_us);
  write_array<std::uint8_t>(out / "colliding", colliding);
  write_array<double>(out / "colliding_us", colliding_us);
  write_array<std::uint32_t>(out / "contacts", contacts);
  write_array<double>(out / "contacts_us", contacts_us);
  write_array<double>(out / "contacts_all_us", contacts_all_us);
  write_array<Vec3>(out / "translation", translation);
  write_array<std::uint32_t>(out / "separating_contacts", separating_contacts);
  write_array<double>(out / "separating_contacts_us", separating_contacts_us);
}

}  // namespace

void add_poses(CLI::App& program) {
  CLI::App& app = *program.add_subcommand(
      "poses",
      "Computes separation, collision and contacts of O1 and O2 in random poses of O2. Writes arrays without "
      "headers into OUT: vertices1, vertices2 (float64), triangles1, triangles2 (uint32), poses (3 × 4, by "
      "rows), separation (float64), colliding (uint8), contacts (their number, uint32), translation (of O1, "
      "float64, 3) and separating_contacts (their number, uint32); the microseconds on one core, "
      "separation_us, colliding_us, contacts_us and separating_contacts_us, and on all cores, "
      "contacts_all_us. batch_us: those for each pose of a call of PoseQuery::colliding for all poses, on "
      "one core and on all. Of convex bodies, random_poses (3 × 4), random_colliding (uint8) and random_us, "
      "the same for other random poses, few of which touch. clock_us: the time that the clock takes.");
  const auto options = std::make_shared<PoseSamples>();
  app.add_option("O1", options->o1, "A mesh of the benchmarks, box, or hull:N, with 8 · 4^N triangles")
      ->required();
  app.add_option("O2", options->o2, "The same")->required();
  app.add_option("PARTS", options->parts, "Triangles are divided into PARTS² triangles")->required();
  app.add_option("COUNT", options->count, "Number of poses")->required();
  app.add_option("OUT", options->out)->required();
  app.callback([options] { write_pose_samples(*options); });
}

}  // namespace sdm::bench
