// Calls that change nothing, when memory runs out: an error, and afterwards the right result.
#include <gtest/gtest.h>
#include <sdm/hausdorff.h>
#include <sdm/map.h>
#include <sdm/mesh_files.h>
#include <sdm/volume.h>

#include <fstream>

#include "io/page/player/sequence_player.h"
#include "memory/all_or_nothing.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

struct TwoMeshes {
  Surface surface{sphere(1), {.resolution = 32}};
  Sites sites{joined(cube(0.7), moved(sphere(0), {0.5, 0.2, 0.1}))};  // intersects itself
};
std::unique_ptr<TwoMeshes> two_meshes() {
  return std::make_unique<TwoMeshes>();
}

TEST(FailedAllocations, MapsAreComputedByTheNextCall) {
  for (const auto& engine : engines()) {
    if (engine.name == "gl" || engine.name == "gpu") continue;  // drivers allocate, in threads of their own
    for (const SignMethod sign : {SignMethod::exact, SignMethod::winding}) {
      const std::function<Numbers(TwoMeshes&)> map = [&](TwoMeshes& m) {
        const DistanceMap found =
            compute_map(m.surface, m.sites, {.engine = make_engine(engine.name), .sign = sign});
        return numbers_of(found.distance, found.vector, found.site);
      };
      expect_repeatable(two_meshes, map);
    }
  }
}

TEST(FailedAllocations, DistancesOfVerticesAreComputedByTheNextCall) {
  const std::function<Numbers(TwoMeshes&)> call = [](TwoMeshes& m) {
    return numbers_of(distances_at_vertices(m.surface.mesh(), m.sites));
  };
  expect_repeatable(two_meshes, call);
}

TEST(FailedAllocations, HausdorffDistancesAreComputedByTheNextCall) {
  const std::function<Numbers(TwoMeshes&)> call = [](TwoMeshes& m) {
    const HausdorffDistance found = one_sided_hausdorff(m.surface.mesh(), m.sites);
    return numbers_of(found.distance.lower, found.distance.upper, found.faces);
  };
  expect_repeatable(two_meshes, call);
}

TEST(FailedAllocations, FieldsAreComputedByTheNextCall) {
  for (const double band : {0.5, std::numeric_limits<double>::infinity()}) {
    const std::function<Numbers(TwoMeshes&)> call = [&](TwoMeshes& m) {
      const Grid grid = make_grid(Box{{-1, -1, -1}, {1.5, 1, 1}}, std::array<std::uint32_t, 3>{6, 5, 5});
      return numbers_of(compute_field(m.sites, grid, {.max_distance = band}).distance);
    };
    expect_repeatable(two_meshes, call);
  }
}

struct Files {
  TemporaryFolder folder;
  std::filesystem::path mesh = folder / "mesh.obj";
  std::string frames = folder / "frames";

  Files() {
    write(mesh, 4);
    std::filesystem::create_directory(frames);
    for (int i = 0; i < 3; ++i) write(frames + "/" + std::to_string(i) + ".obj", 3 + i);
  }
  static void write(const std::filesystem::path& name, int faces) {
    std::ofstream out(name);
    out << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\n";
    for (int f = 0; f < faces; ++f)
      out << "f " << f % 5 + 1 << ' ' << (f + 1) % 5 + 1 << ' ' << (f + 2) % 5 + 1 << '\n';
  }
};

TEST(FailedAllocations, FilesAreReadByTheNextCall) {
  const std::function<Numbers(Files&)> read = [](Files& files) { return numbers_of(read_mesh(files.mesh)); };
  expect_repeatable([] { return std::make_unique<Files>(); }, read);
}

TEST(FailedAllocations, LeaveASequenceAtTheFrameBefore) {
  const Files files;
  for (const bool topology : {false, true}) {
    if (!topology)
      for (int i = 0; i < 3; ++i) Files::write(files.frames + "/" + std::to_string(i) + ".obj", 4);
    const auto make = [&] {
      auto sequence =
          std::make_unique<MeshSequence>(files.frames, SequenceOptions{.allow_topology = topology});
      (void)sequence->positions(1);
      return sequence;
    };
    const std::function<Numbers(MeshSequence&)> read = [](MeshSequence& s) {
      Numbers numbers = numbers_of(s.positions(2));
      numbers.add(s.mesh());
      return numbers;
    };
    expect_repeatable(make, read);
  }
}

TEST(FailedAllocations, LeaveAPlayerWithTheFramesBefore) {
  const Sites a(tetrahedron()), b(cube()), moved_a(moved(tetrahedron(), {0.2, 0, 0}));
  const auto make = [&] {
    auto player = std::make_unique<SequencePlayer>(a.mesh(), b.mesh(), true);
    player->add(0, a, b);
    return player;
  };
  const std::function<void(SequencePlayer&)> add = [&](SequencePlayer& p) { p.add(1, moved_a, b); };
  const Calls<SequencePlayer> calls{[](SequencePlayer& p) { return numbers_of(p.frames()); },
                                    [](SequencePlayer& p) { return numbers_of(*p.colors({}).range); }};
  EXPECT_EQ(expect_all_or_nothing(make, add, calls, Guarantee::unchanged), 0u);
}

}  // namespace
}  // namespace sdm::test
