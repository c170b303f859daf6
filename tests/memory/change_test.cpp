// Meshes, surfaces, sites and what is collected from maps, when memory runs out during a change.
#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/map.h>
#include <sdm/sampling_bound.h>
#include <sdm/sites.h>
#include <sdm/statistics.h>

#include "memory/all_or_nothing.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

const std::vector<Vec3> kPoints{{0, 0, 0}, {0.3, 0.2, 0.9}, {-2, 0.5, 1}, {0.1, -1.2, 0.4}, {3, 3, 3}};

std::vector<Vec3> bent(const Mesh& mesh) {
  std::vector<Vec3> positions = mesh.positions;
  for (Vec3& p : positions) p = {p[0] + 0.2 * p[1] * p[1], 0.9 * p[1], p[2] + 0.1 * p[0]};
  return positions;
}

// Removes, reconnects, moves and adds.
MeshEdit some_edit(const Mesh& mesh) {
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  const Triangle t = mesh.triangles[5], u = mesh.triangles[1];
  const Vec3 p = mesh.positions[t[0]];
  MeshEdit edit{.removed_faces = {0, 3},
                .reconnected_faces = {{5, {n, t[1], t[2]}}},
                .moved_vertices = {{t[1], {1.1 * p[0], p[1] + 0.1, p[2]}}},
                .added_vertices = {{p[0] + 0.1, p[1], p[2] + 0.2}, {p[0] - 0.2, p[1] + 0.3, p[2] + 0.4}},
                .added_faces = {{u[0], u[1], n + 1}, {n, n + 1, u[2]}, {u[1], u[2], n + 1}}};
  if (!mesh.corner_uvs.empty()) edit.added_corner_uvs.assign(3, {{{0, 0}, {0.1, 0}, {0, 0.1}}});
  return edit;
}

// Closed, open, of several shells one inside another, and with duplicate and degenerate faces.
std::vector<Mesh> meshes() {
  Mesh defects = cube();
  defects.triangles.push_back(defects.triangles[7]);
  defects.triangles.push_back({0, 0, 1});
  return {sphere(1), height_field(4), joined(sphere(0), joined(cube(2), moved(sphere(0), {5, 0, 0}))),
          defects};
}

const Calls<Sites> kSites{
    [](Sites& s) { return numbers_of(s.mesh()); },
    [](Sites& s) { return numbers_of(s.edges()); },
    [](Sites& s) { return numbers_of(s.closed()); },
    [](Sites& s) { return numbers_of(s.orientable()); },
    [](Sites& s) {
      Numbers numbers;
      for (const auto& info : engines())
        if (info.takes_points && info.name != "gpu")  // its driver allocates
          for (const ClosestPoint& c : closest_points(s, kPoints, {.engine = make_engine(info.name)}))
            numbers.add(c.point, c.distance, c.site, c.type, c.face);
      return numbers;
    },
    [](Sites& s) { return numbers_of(self_intersections(s)); },
    [](Sites& s) {
      const DistanceMap map = compute_map(Surface(tetrahedron(), {.resolution = 16}), s);
      return numbers_of(map.distance, map.vector, map.site, map.site_type);
    }};

// Refits allocate nothing but tasks, of which loops of one part have none.
TEST(FailedAllocations, LeaveSitesAsTheyWereOrBrokenByARefit) {
  for (const Mesh& mesh : {sphere(4), height_field(50)}) {
    const auto make = [&] { return std::make_unique<Sites>(mesh); };
    const std::vector<Vec3> positions = bent(mesh);
    const std::function<void(Sites&)> refit = [&](Sites& s) { s.refit(positions); };
    EXPECT_GT(expect_all_or_nothing(make, refit, kSites, Guarantee::unchanged_or_broken,
                                    FailingAllocation::Tasks::all),
              0u);
  }
}

TEST(FailedAllocations, LeaveSitesAsTheyWereByAnEdit) {
  for (const Mesh& mesh : meshes()) {
    const auto make = [&] { return std::make_unique<Sites>(mesh); };
    const MeshEdit change = some_edit(mesh);
    const std::function<void(Sites&)> edit = [&](Sites& s) { s.edit(change); };
    EXPECT_EQ(expect_all_or_nothing(make, edit, kSites, Guarantee::unchanged), 0u);
  }
}

const Calls<Surface> kSurface{
    [](Surface& s) { return numbers_of(s.mesh()); },
    [](Surface& s) { return numbers_of(s.atlas_kind(), s.resolution(), s.gutter(), s.max_stretch()); },
    [](Surface& s) { return numbers_of(s.rows(), s.utilisation(), s.overlapping_texels()); },
    [](Surface& s) { return numbers_of(s.texel_faces()); },
    [](Surface& s) { return numbers_of(s.sample_texels(), s.sample_points()); },
    [](Surface& s) { return numbers_of(s.texel_point(s.sample_texels()[3])); },
    [](Surface& s) { return numbers_of(s.chart_count(), s.face_charts()); },
    [](Surface& s) { return numbers_of(s.stored_atlas()); },
    [](Surface& s) {
      Numbers numbers;
      for (std::uint32_t f = 0; f < s.mesh().triangles.size(); ++f)
        if (s.face_charts()[f] != kNone)
          numbers.add(s.atlas_corners(f), s.texel_edges(f), s.to_atlas(f, {1, 2, 3}),
                      s.to_surface(f, {4, 5}));
      return numbers;
    },
    [](Surface& s) { return numbers_of(SamplingBound(s).sample_radii()); },
    [](Surface& s) { return numbers_of(compute_map(s, Sites(tetrahedron())).distance); }};

struct Atlas {
  Mesh mesh;
  AtlasOptions options;
};
std::vector<Atlas> atlases() {
  return {{sphere(0), {.kind = AtlasKind::charts, .resolution = 24}},
          {cube(), {.kind = AtlasKind::triangles, .resolution = 24}},
          {height_field(2), {.kind = AtlasKind::uv, .resolution = 16}}};
}

TEST(FailedAllocations, LeaveASurfaceAsItWasOrBrokenByARefit) {
  const Mesh mesh = sphere(4);
  const std::vector<Vec3> positions = bent(mesh);
  const std::function<void(Surface&)> refit = [&](Surface& s) { s.refit(positions); };
  const auto make = [&] { return std::make_unique<Surface>(mesh, AtlasOptions{.resolution = 64}); };
  EXPECT_GT(expect_all_or_nothing(make, refit, kSurface, Guarantee::unchanged_or_broken,
                                  FailingAllocation::Tasks::all),
            0u);
}

// Once, 42 of 518 failures changed the mesh.
TEST(FailedAllocations, LeaveASurfaceAsItWasByAnEdit) {
  for (const auto& [mesh, options] : atlases()) {
    const MeshEdit change = some_edit(mesh);
    const std::function<void(Surface&)> edit = [&](Surface& s) { s.edit(change); };
    EXPECT_EQ(expect_all_or_nothing([&] { return std::make_unique<Surface>(mesh, options); }, edit, kSurface,
                                    Guarantee::unchanged),
              0u);
  }
}

// Where rows are added, and where the surface has been edited before.
TEST(FailedAllocations, LeaveASurfaceAsItWasByAnotherEdit) {
  const Mesh mesh = sphere(0);
  const MeshEdit first = some_edit(mesh);
  MeshEdit second;
  for (std::uint32_t f = 6; f < 20; ++f) second.added_faces.push_back(mesh.triangles[f]);
  second.removed_faces = {2};
  const auto make = [&] {
    auto surface = std::make_unique<Surface>(mesh, AtlasOptions{.resolution = 16});
    surface->edit(first);
    return surface;
  };
  const std::function<void(Surface&)> edit = [&](Surface& s) { s.edit(second); };
  EXPECT_EQ(expect_all_or_nothing(make, edit, kSurface, Guarantee::unchanged), 0u);
}

TEST(FailedAllocations, LeaveAMeshAsItWasByAnEdit) {
  for (const Mesh& mesh : meshes()) {
    const MeshEdit change = some_edit(mesh);
    const std::function<void(Mesh&)> edit = [&](Mesh& m) { apply(m, change); };
    const Calls<Mesh> calls{[](Mesh& m) { return numbers_of(m); }};
    EXPECT_EQ(expect_all_or_nothing([&] { return std::make_unique<Mesh>(mesh); }, edit, calls,
                                    Guarantee::unchanged),
              0u);
  }
}

TEST(FailedAllocations, LeaveASamplingBoundAsItWasOrBroken) {
  Surface moved(sphere(1), {.resolution = 256});
  const auto make = [&] {
    moved.refit(sphere(1).positions);
    auto bound = std::make_unique<SamplingBound>(moved);
    moved.refit(bent(sphere(1)));
    return bound;
  };
  const std::function<void(SamplingBound&)> refit = [&](SamplingBound& b) { b.refit(moved); };
  const Calls<SamplingBound> calls{[](SamplingBound& b) { return numbers_of(b.value()); },
                                   [](SamplingBound& b) { return numbers_of(b.value_after(0.5)); },
                                   [](SamplingBound& b) { return numbers_of(b.sample_radii()); },
                                   [](SamplingBound& b) { return numbers_of(b.face_radii()); }};
  EXPECT_GT(expect_all_or_nothing(make, refit, calls, Guarantee::unchanged_or_broken,
                                  FailingAllocation::Tasks::all),
            0u);
}

const Calls<TemporalMaps> kTemporalMaps{
    [](TemporalMaps& m) { return numbers_of(m.maps(), m.resolution()); },
    [](TemporalMaps& m) { return numbers_of(m.least(), m.largest(), m.mean()); },
    [](TemporalMaps& m) { return numbers_of(m.state().sum); }};

TEST(FailedAllocations, LeaveMapsOverTimeAsTheyWere) {
  const Surface surface(sphere(1), {.resolution = 32});
  const DistanceMap map = compute_map(surface, Sites(cube()));
  const std::function<void(TemporalMaps&)> add = [&](TemporalMaps& m) { m.add(map); };
  for (const int earlier : {0, 1}) {
    const auto make = [&] {
      auto maps = std::make_unique<TemporalMaps>();
      for (int i = 0; i < earlier; ++i) maps->add(compute_map(surface, Sites(sphere(0))));
      return maps;
    };
    EXPECT_EQ(
        expect_all_or_nothing(make, add, kTemporalMaps, Guarantee::unchanged, FailingAllocation::Tasks::all),
        0u);
  }
}

TEST(FailedAllocations, LeaveMapsOverTimeAsTheyWereWhenTheyFollowAnEdit) {
  Surface surface(sphere(0), {.resolution = 16});
  TemporalMaps before;
  before.add(compute_map(surface, Sites(cube())));
  const std::vector<std::uint32_t> owners(surface.texel_faces().begin(), surface.texel_faces().end());
  MeshEdit rows{.removed_faces = {0}};
  for (std::uint32_t f = 1; f < 20; ++f) rows.added_faces.push_back(surface.mesh().triangles[f]);
  surface.edit(rows);
  ASSERT_GT(surface.rows(), 16u);
  const std::function<void(TemporalMaps&)> follow = [&](TemporalMaps& m) { m.follow_edit(owners, surface); };
  EXPECT_EQ(expect_all_or_nothing([&] { return std::make_unique<TemporalMaps>(before); }, follow,
                                  kTemporalMaps, Guarantee::unchanged),
            0u);
}

TEST(FailedAllocations, LeaveCombinedStatisticsAsTheyWere) {
  const Surface surface(sphere(1), {.resolution = 32});
  const DistanceMap map = compute_map(surface, Sites(cube(0.2))), first = compute_map(surface, Sites(cube()));
  const auto make = [&] {
    auto combined = std::make_unique<CombinedStatistics>();
    combined->add(surface, first);
    return combined;
  };
  const std::function<void(CombinedStatistics&)> add = [&](CombinedStatistics& c) { c.add(surface, map); };
  const Calls<CombinedStatistics> calls{[](CombinedStatistics& c) {
    const DistanceStatistics found = c.statistics();
    return numbers_of(found.texels, found.min, found.max, found.mean, found.rms);
  }};
  EXPECT_EQ(expect_all_or_nothing(make, add, calls, Guarantee::unchanged), 0u);
}

}  // namespace
}  // namespace sdm::test
