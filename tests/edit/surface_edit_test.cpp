// Surfaces after edits: the atlas of what stays is kept to the bit, added faces are laid out like the rest.
#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/sampling_bound.h>
#include <sdm/statistics.h>

#include "atlas/invariants.h"
#include "edit/random_edits.h"
#include "support/points.h"
#include "support/shapes.h"
#include "surface/surface_data.h"

namespace sdm {
namespace {

// The singular values of M⁻¹ of a face, the smaller first.
Vec2 stretches(const Surface& surface, std::uint32_t face) {
  const auto [du, dv] = surface.texel_edges(face);
  const double e = dot(du, du), g = dot(dv, dv), h = std::hypot((e - g) / 2, dot(du, dv));
  return {std::sqrt((e + g) / 2 - h), std::sqrt((e + g) / 2 + h)};
}

struct Snapshot {
  Mesh mesh;
  std::vector<atlas::FaceMap> maps;
  std::vector<std::array<Vec2, 3>> corners;
  std::vector<std::uint32_t> charts, owners;
  std::uint32_t rows;

  explicit Snapshot(const Surface& surface)
      : mesh(surface.mesh()),
        maps(internals(surface).maps),
        corners(internals(surface).corners),
        charts(internals(surface).face_charts),
        owners(internals(surface).map_faces),
        rows(surface.rows()) {}
};

// The faces with an area that own no texel, ascending, follow the texels, and all of these are samples once.
void expect_own_points(const Surface& surface) {
  const auto owners = surface.texel_faces();
  ASSERT_EQ(owners.size(), std::size_t{surface.rows()} * surface.resolution());
  std::vector<std::uint32_t> count(surface.mesh().triangles.size()), without, samples;
  for (std::uint32_t texel = 0; texel < owners.size(); ++texel)
    if (owners[texel] != kNone) {
      ++count[owners[texel]];
      samples.push_back(texel);
    }
  for (std::uint32_t f = 0; f < count.size(); ++f) {
    if (surface.face_charts()[f] == kNone || count[f] > 0) continue;
    samples.push_back(static_cast<std::uint32_t>(owners.size() + without.size()));
    without.push_back(f);
    ++count[f];
  }
  EXPECT_TRUE(std::ranges::equal(surface.map_faces().subspan(owners.size()), without));
  EXPECT_EQ(internals(surface).face_samples, count);
  std::vector<std::uint32_t> found(surface.sample_texels().begin(), surface.sample_texels().end());
  for (std::size_t i = 0; i < found.size(); ++i)
    ASSERT_EQ(internals(surface).sample_faces[i], surface.map_faces()[found[i]]);
  std::ranges::sort(found);
  EXPECT_EQ(found, samples);
}

void expect_kept(const Snapshot& before, const Surface& after) {
  const surface::SurfaceData& now = internals(after);
  ASSERT_GE(now.rows, before.rows);
  expect_own_points(after);
  std::size_t changed = 0, taken = 0;
  for (std::uint32_t f = 0; f < before.corners.size(); ++f) {
    if (is_removed(now.mesh.triangles[f])) {
      EXPECT_EQ(now.face_charts[f], kNone);
      continue;
    }
    changed += now.corners[f] != before.corners[f] || now.face_charts[f] != before.charts[f] ||
               now.maps[f].origin != before.maps[f].origin;
    bool moved = false;
    for (int k = 0; k < 3; ++k)
      moved |=
          before.mesh.positions[before.mesh.triangles[f][k]] != now.mesh.positions[now.mesh.triangles[f][k]];
    changed += !moved && now.maps[f].edges != before.maps[f].edges;
  }
  for (std::size_t texel = 0; texel < std::size_t{before.rows} * now.resolution; ++texel) {
    const std::uint32_t owner = before.owners[texel];
    const bool stays = owner != kNone && !is_removed(now.mesh.triangles[owner]);
    changed += stays && now.map_faces[texel] != owner;
    taken += !stays && now.map_faces[texel] != kNone && now.map_faces[texel] < before.corners.size();
  }
  EXPECT_EQ(changed, 0u);
  EXPECT_EQ(taken, 0u);  // free texels go to added faces only
}

// Every added face with an area is mapped at the scale of the layout, within the stretch.
void expect_scale(const Surface& surface, std::size_t first, double scale, double max_stretch) {
  for (auto f = static_cast<std::uint32_t>(first); f < surface.mesh().triangles.size(); ++f) {
    if (surface.face_charts()[f] == kNone) continue;
    const auto [least, most] = stretches(surface, f);
    EXPECT_NEAR(least, 1 / scale, 1e-6 / scale) << f;
    EXPECT_LE(most, (1 + 1e-6) * max_stretch / scale) << f;
  }
}

void expect_bounded(const Surface& surface, std::mt19937& random) {
  const SamplingBound bound(surface);
  const std::vector<Vec3> samples = surface.sample_points();
  for (const Vec3& p : test::random_surface_points(surface.mesh(), 60, random)) {
    double excess = 1;
    for (std::size_t i = 0; i < samples.size(); ++i)
      excess = std::min(excess, norm(p - samples[i]) - bound.sample_radii()[i]);
    EXPECT_LE(excess, 1e-12);
  }
  EXPECT_NEAR(covering_radius(surface), bound.value(), 1e-5 * bound.value());
}

void expect_map(const Surface& surface) {
  const Sites sites(test::moved(test::sphere(1), {0.3, 0.1, 2}));
  const DistanceMap map = compute_map(surface, sites, {.sign = SignMethod::none});
  EXPECT_EQ(map.rows(), surface.rows());
  ASSERT_EQ(map.distance.size(), surface.map_faces().size());
  const auto closest = closest_points(sites, surface.sample_points());
  std::size_t wrong = 0, unowned = 0;
  for (std::size_t i = 0; i < closest.size(); ++i)
    wrong += !(std::abs(map.distance[surface.sample_texels()[i]] - closest[i].distance) <= 1e-5);
  for (std::size_t texel = 0; texel < map.distance.size(); ++texel)
    unowned += std::isnan(map.distance[texel]) != (surface.map_faces()[texel] == kNone);
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(unowned, 0u);
  EXPECT_EQ(statistics(surface, map).texels, surface.sample_texels().size());
}

struct AtlasCase {
  const char* name;
  AtlasOptions options;
};
class EditedSurface : public testing::TestWithParam<AtlasCase> {};

TEST_P(EditedSurface, KeepsWhatStaysAndAddsWhatIsNew) {
  const AtlasOptions& options = GetParam().options;
  std::mt19937 random(1);
  Mesh mesh = test::torus(24, 16);
  Surface surface(mesh, options);
  const double scale = internals(surface).scale;
  test::RandomEdits edits(7, {.moves = false, .defects = true});
  for (int i = 0; i < 150; ++i) {
    SCOPED_TRACE(i);
    const Snapshot before(surface);
    const MeshEdit edit = edits.next(surface.mesh());
    surface.edit(edit);
    apply(mesh, edit);
    ASSERT_EQ(surface.mesh().triangles, mesh.triangles);
    expect_kept(before, surface);
    expect_scale(surface, before.corners.size(), scale, std::max(1.0, options.max_stretch));
    test::expect_samples(surface);
    if (i % 10 == 9) {
      if (options.kind != AtlasKind::uv) {
        test::expect_owners(surface);
        test::expect_gutters(surface, options.gutter);
      }
      test::expect_maps(surface);
      expect_bounded(surface, random);
      expect_map(surface);
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(surface.rows(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Atlases, EditedSurface,
                         testing::Values(AtlasCase{"charts", {.resolution = 256}},
                                         AtlasCase{"wide_gutters", {.resolution = 200, .gutter = 3}},
                                         AtlasCase{"no_gutters", {.resolution = 128, .gutter = 0}},
                                         AtlasCase{"triangles",
                                                   {.kind = AtlasKind::triangles, .resolution = 256}},
                                         AtlasCase{"uv", {.kind = AtlasKind::uv, .resolution = 256}}),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

TEST(SurfaceEdit, TearsWithoutAnyChangeOfTheAtlas) {
  const Mesh mesh = test::torus(24, 16);
  Surface surface(mesh, {.resolution = 256});
  const Snapshot before(surface);
  MeshEdit edit;
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t f = 0; f < 6; ++f) {
    Triangle t = mesh.triangles[f];
    edit.added_vertices.push_back(mesh.positions[t[0]]);
    t[0] = n + f;
    edit.reconnected_faces.push_back({f, t});
  }
  surface.edit(edit);
  expect_kept(before, surface);
  EXPECT_EQ(surface.rows(), 256u);
  EXPECT_EQ(internals(surface).map_faces, before.owners);
  EXPECT_EQ(internals(surface).maps.size(), before.maps.size());
}

TEST(SurfaceEdit, UsesFreeRoomBeforeItAddsRows) {
  const Mesh mesh = test::torus(24, 16);
  Surface surface(mesh, {.resolution = 256});
  const std::size_t samples = surface.sample_texels().size();
  // The same faces go and come back, again and again.
  std::vector<std::uint32_t> faces{100, 101, 102, 103};
  for (int i = 0; i < 50; ++i) {
    MeshEdit remove{.removed_faces = faces}, add;
    for (std::uint32_t f = 100; f < 104; ++f) add.added_faces.push_back(mesh.triangles[f]);
    surface.edit(remove);
    for (std::uint32_t& f : faces)
      f = static_cast<std::uint32_t>(surface.mesh().triangles.size() + (&f - faces.data()));
    surface.edit(add);
  }
  EXPECT_EQ(surface.rows(), 256u);
  EXPECT_NEAR(static_cast<double>(surface.sample_texels().size()), static_cast<double>(samples),
              1e-3 * static_cast<double>(samples));
  test::expect_owners(surface);
}

TEST(SurfaceEdit, AddsRowsBelow) {
  const Mesh mesh = test::torus(24, 16), more = test::moved(mesh, {8, 0, 0});
  Surface surface(mesh, {.resolution = 256});
  const Snapshot before(surface);
  MeshEdit edit{.added_vertices = more.positions};
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  for (const auto& [a, b, c] : more.triangles) edit.added_faces.push_back({a + n, b + n, c + n});
  surface.edit(edit);
  expect_kept(before, surface);
  EXPECT_GT(surface.rows(), 256u + 128);
  EXPECT_LT(surface.rows(), 2u * 256 + 64);
  EXPECT_EQ(surface.rows() % 32, 0u);
  test::expect_owners(surface);
  test::expect_gutters(surface, 1);
  expect_map(surface);
  // As a stored atlas, too.
  const Surface restored(surface.mesh(), {.resolution = 256}, surface.stored_atlas());
  EXPECT_EQ(restored.rows(), surface.rows());
  EXPECT_EQ(internals(restored).map_faces, internals(surface).map_faces);
  EXPECT_EQ(internals(restored).scale, internals(surface).scale);
}

TEST(SurfaceEdit, RefusesChartsWiderThanTheAtlas) {
  const Mesh mesh = test::torus(24, 16);
  Surface surface(mesh, {.resolution = 64});
  const Snapshot before(surface);
  try {
    surface.edit({.added_vertices = {{0, 0, 0}, {1e3, 0, 0}, {0, 1e3, 0}}, .added_faces = {{384, 385, 386}}});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("lay out the edited mesh anew"), std::string::npos);
  }
  EXPECT_EQ(surface.mesh().triangles, mesh.triangles);
  expect_kept(before, surface);
  surface.edit({.removed_faces = {1}, .added_faces = {mesh.triangles[1]}});  // still usable
  test::expect_owners(surface);
}

TEST(SurfaceEdit, DoesNotDependOnThreads) {
  std::vector<std::vector<std::uint32_t>> owners, samples;
  for (const unsigned threads : {1u, 3u}) {
    const ThreadLimit limit(threads);
    Surface surface(test::torus(24, 16), {.resolution = 256});
    test::RandomEdits edits(3, {});
    for (int i = 0; i < 20; ++i) surface.edit(edits.next(surface.mesh()));
    owners.push_back(internals(surface).map_faces);
    samples.push_back(internals(surface).samples);
  }
  EXPECT_EQ(owners[0], owners[1]);
  EXPECT_EQ(samples[0], samples[1]);
}

TEST(SurfaceEdit, RefitsFollowAnEdit) {
  Surface surface(test::torus(24, 16), {.resolution = 256});
  test::RandomEdits edits(3, {});
  for (int i = 0; i < 20; ++i) surface.edit(edits.next(surface.mesh()));
  std::vector<Vec3> moved = surface.mesh().positions;
  for (Vec3& p : moved) p = {p[0] + 0.2 * p[1], p[1], 1.5 * p[2]};
  surface.refit(moved);
  test::expect_maps(surface);
  std::mt19937 random(2);
  expect_bounded(surface, random);
}

// Even if the numbers of faces and samples are the same.
TEST(SurfaceEdit, ABoundFromBeforeTheEditIsRefused) {
  Surface surface(test::ring(10), {.resolution = 64});
  SamplingBound bound(surface);
  surface.refit(test::ring(10, 1.5).positions);
  bound.refit(surface);
  Surface same = std::move(surface);
  bound.refit(same);
  const double before = bound.value();
  const std::size_t faces = same.mesh().triangles.size(), samples = same.sample_texels().size();
  same.edit({.reconnected_faces = {{0, {0, 1, 2}}}});
  ASSERT_EQ(same.mesh().triangles.size(), faces);
  ASSERT_EQ(same.sample_texels().size(), samples);
  EXPECT_THROW(bound.refit(same), Error);
  EXPECT_THROW(RelativeError(same, bound), Error);
  EXPECT_EQ(bound.value(), before);
  bound = SamplingBound(same);
  bound.refit(same);
}

// Of faces that stay, these samples keep their places; added faces that own no texel get some.
TEST(SurfaceEdit, FacesWithoutATexelKeepTheirSamples) {
  const Mesh mesh = test::sphere(4);
  const AtlasOptions options{.resolution = 32};
  Surface surface(mesh, options);
  const auto points_of_faces = [&] {
    std::vector<std::vector<Vec3>> points(surface.mesh().triangles.size());
    for (const std::uint32_t sample : surface.sample_texels())
      points[surface.map_faces()[sample]].push_back(surface.texel_point(sample));
    for (std::vector<Vec3>& of_face : points) std::ranges::sort(of_face);
    return points;
  };
  constexpr std::uint32_t kRemoved = 800;
  MeshEdit edit;
  for (std::uint32_t f = 0; f < kRemoved; ++f) {
    edit.removed_faces.push_back(f);
    edit.added_faces.push_back(mesh.triangles[f]);
  }
  const Snapshot before(surface);
  const auto points = points_of_faces();
  surface.edit(edit);
  expect_kept(before, surface);
  EXPECT_GT(surface.map_faces().back(), mesh.triangles.size()) << "an added face";
  const auto now = points_of_faces();
  for (std::size_t f = kRemoved; f < points.size(); ++f) ASSERT_EQ(now[f], points[f]) << f;
  for (std::size_t f = points.size(); f < now.size(); ++f) ASSERT_FALSE(now[f].empty()) << f;
  expect_map(surface);
  std::mt19937 random(3);
  expect_bounded(surface, random);
  const Surface restored(surface.mesh(), options, surface.stored_atlas());
  EXPECT_TRUE(std::ranges::equal(restored.map_faces(), surface.map_faces()));
  EXPECT_EQ(restored.sample_points(), surface.sample_points());
}

}  // namespace
}  // namespace sdm
