// Times queries of two meshes in random poses, and writes meshes, poses and results for other libraries, for
// bench/peers.
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <random>
#include <vector>

#include "arrays.h"
#include "core/stopwatch.h"
#include "mesh/similarity.h"
#include "poses.h"
#include "refine_mesh.h"
#include "scenes.h"

int main(int argc, char** argv) try {
  using namespace sdm;
  CLI::App app(
      "Computes separation, collision and contacts of O1 and O2 in random poses of O2. Writes arrays without "
      "headers into OUT: vertices1, vertices2 (float64), triangles1, triangles2 (uint32), poses (3 × 4, by "
      "rows), separation (float64), colliding (uint8), contacts (their number, uint32); the microseconds on "
      "one core, separation_us, colliding_us and contacts_us; and on all cores, contacts_all_us.");
  std::string o1, o2;
  std::filesystem::path out;
  std::uint32_t parts = 1, count = 200;
  app.add_option("O1", o1, "A mesh of the benchmarks")->required();
  app.add_option("O2", o2, "A mesh of the benchmarks")->required();
  app.add_option("PARTS", parts, "Triangles are divided into PARTS² triangles")->required();
  app.add_option("COUNT", count, "Number of poses")->required();
  app.add_option("OUT", out)->required();
  CLI11_PARSE(app, argc, argv);

  const Mesh m1 = bench::refine_mesh(bench::load(o1, "fit"), parts, 0),
             m2 = bench::refine_mesh(bench::load(o2, "fit"), parts, 0);
  std::mt19937 random(1);
  const std::vector<Affine> placements = bench::random_poses(Sites(m1), Sites(m2), count, random);
  ProximityQuery query(m1, m2);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<double> poses, separation(count), separation_us(count, kInfinity),
      colliding_us(count, kInfinity), contacts_us(count, kInfinity), contacts_all_us(count, kInfinity);
  std::vector<std::uint8_t> colliding(count);
  std::vector<std::uint32_t> contacts(count);
  for (const Affine& pose : placements)
    for (std::size_t row = 0; row < 3; ++row) {
      poses.insert(poses.end(), pose.rows[row].begin(), pose.rows[row].end());
      poses.push_back(pose.offset[row]);
    }
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
  for (int turn = 0; turn < kTurns; ++turn) {
    time(contacts_all_us, find_contacts);
    const ThreadLimit alone(1);
    time(separation_us, [&](std::size_t i) { separation[i] = query.separation().value; });
    time(colliding_us, [&](std::size_t i) { colliding[i] = query.colliding(); });
    time(contacts_us, find_contacts);
  }
  bench::write_array<Vec3>(out / "vertices1", m1.positions);
  bench::write_array<Vec3>(out / "vertices2", m2.positions);
  bench::write_array<Triangle>(out / "triangles1", m1.triangles);
  bench::write_array<Triangle>(out / "triangles2", m2.triangles);
  bench::write_array<double>(out / "poses", poses);
  bench::write_array<double>(out / "separation", separation);
  bench::write_array<double>(out / "separation_us", separation_us);
  bench::write_array<std::uint8_t>(out / "colliding", colliding);
  bench::write_array<double>(out / "colliding_us", colliding_us);
  bench::write_array<std::uint32_t>(out / "contacts", contacts);
  bench::write_array<double>(out / "contacts_us", contacts_us);
  bench::write_array<double>(out / "contacts_all_us", contacts_all_us);
} catch (const std::exception& error) {
  std::fprintf(stderr, "pose_samples: %s\n", error.what());
  return 1;
}
