#include "engine/support.h"

#include <sdm/io.h>

#include <cmath>
#include <map>

#include "core/geometry/vec.h"
#include "engine/oracle.h"
#include "scenes/placement.h"

namespace sdm::test {

Mesh load(const std::string& name, std::string_view steps) {
  return placed(read_mesh(std::string(SDM_TEST_MESHES) + "/" + name), steps);
}

Mesh placed(Mesh mesh, std::string_view steps) {
  scenes::place(mesh, scenes::parse_placement(steps));
  return mesh;
}

std::vector<Vec3> placed(const std::vector<Vec3>& points, std::string_view steps) {
  return placed(Mesh{.positions = points, .triangles = {{0, 1, 2}}, .corner_uvs = {}}, steps).positions;
}

Mesh cube(double half_side) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back(half_side * Vec3{i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

Mesh sphere(int levels) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  Mesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
    const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, added] =
          midpoints.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
      if (added) mesh.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
      return entry->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& p : mesh.positions) p = normalized(p);
  return mesh;
}

Mesh soup(std::size_t triangles, std::mt19937& random) {
  const Box unit{{0, 0, 0}, {1, 1, 1}}, small{{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}};
  Mesh mesh;
  for (std::size_t i = 0; i < triangles; ++i) {
    const Vec3 middle = random_point(unit, random);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(middle + random_point(small, random));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

Mesh joined(const Mesh& a, const Mesh& b) {
  Mesh mesh = a;
  const auto offset = static_cast<std::uint32_t>(a.positions.size());
  mesh.positions.insert(mesh.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& [i, j, k] : b.triangles) mesh.triangles.push_back({i + offset, j + offset, k + offset});
  mesh.corner_uvs.clear();
  return mesh;
}

Mesh turned(Mesh mesh, std::size_t every) {
  for (std::size_t i = 0; i < mesh.triangles.size(); i += every)
    std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
  mesh.corner_uvs.clear();
  return mesh;
}

Vec3 random_point(const Box& box, std::mt19937& random) {
  Vec3 p;
  for (int k = 0; k < 3; ++k) p[k] = std::uniform_real_distribution(box.lo[k], box.hi[k])(random);
  return p;
}

std::vector<Vec3> random_surface_points(const Mesh& mesh, std::size_t count, std::mt19937& random) {
  std::vector<double> areas;
  for (const auto& [a, b, c] : mesh.triangles)
    areas.push_back(
        norm(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a])));
  std::discrete_distribution<std::size_t> face(areas.begin(), areas.end());
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [a, b, c] = mesh.triangles[face(random)];
    const double s = std::sqrt(unit(random)), t = unit(random);
    points.push_back((1 - s) * mesh.positions[a] + (s * (1 - t)) * mesh.positions[b] +
                     (s * t) * mesh.positions[c]);
  }
  return points;
}

std::vector<Vec3> sample_points(const Surface& surface) {
  std::vector<Vec3> points;
  for (const std::uint32_t texel : surface.sample_texels()) points.push_back(surface.texel_point(texel));
  return points;
}

double scene_diagonal(const Mesh& o1, const Mesh& o2) {
  Box box = bounds(o1);
  extend(box, bounds(o2));
  return diagonal(box);
}

std::vector<std::string> engine_names() {
  std::vector<std::string> names;
  for (const EngineInfo& info : engines())
    if (!info.maps_only) names.emplace_back(info.name);
  return names;
}

std::string engine_name(const testing::TestParamInfo<std::string>& parameter) {
  return parameter.param;
}

void Disagreements::compare(std::size_t index, double actual, double expected) {
  const double difference = std::abs(actual - expected);
  if (difference <= tolerance_) return;  // NaN is a disagreement
  ++count_;
  if (count_ == 1 || difference > worst_ || std::isnan(difference)) {
    worst_ = difference;
    worst_index_ = index;
    worst_actual_ = actual;
    worst_expected_ = expected;
  }
}

testing::AssertionResult Disagreements::none() const {
  if (count_ == 0) return testing::AssertionSuccess();
  return testing::AssertionFailure() << count_ << " disagree by more than " << tolerance_
                                     << "; the worst, number " << worst_index_ << ", is " << worst_actual_
                                     << " instead of " << worst_expected_;
}

double distance_to_site(const Sites& sites, SiteType type, std::uint32_t site, const Vec3& point) {
  const Mesh& mesh = sites.mesh();
  const auto at = [&](std::uint32_t v) { return mesh.positions[v]; };
  if (type == SiteType::vertex && site < mesh.positions.size()) return norm(point - at(site));
  if (type == SiteType::edge && site < sites.edges().size())
    return oracle::distance(point, at(sites.edges()[site][0]), at(sites.edges()[site][1]));
  if (type == SiteType::face && site < mesh.triangles.size()) {
    const auto& [a, b, c] = mesh.triangles[site];
    return oracle::distance(point, at(a), at(b), at(c));
  }
  return std::numeric_limits<double>::quiet_NaN();
}

void expect_map(const Surface& surface, const Sites& sites, const DistanceMap& map,
                const std::vector<double>& expected, double tolerance) {
  const std::size_t texels = std::size_t{surface.resolution()} * surface.resolution();
  ASSERT_EQ(map.resolution, surface.resolution());
  ASSERT_EQ(map.distance.size(), texels);
  ASSERT_EQ(map.vector.size(), texels);
  ASSERT_EQ(map.site.size(), texels);
  ASSERT_EQ(map.site_type.size(), texels);
  ASSERT_EQ(expected.size(), surface.sample_texels().size());
  EXPECT_EQ(map.beyond_max_distance, 0u);

  Disagreements distances(tolerance), sites_named(tolerance);
  Disagreements lengths(4 * std::numeric_limits<float>::epsilon());  // relative: both are rounded to float
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::uint32_t t = surface.sample_texels()[i];
    const Vec3 vector{map.vector[t][0], map.vector[t][1], map.vector[t][2]};
    const double distance = std::abs(map.distance[t]), length = norm(vector);
    distances.compare(i, distance, expected[i]);
    lengths.compare(i, distance > 0 ? length / distance : 1 + length, 1);
    sites_named.compare(
        i, distance_to_site(sites, map.site_type[t], map.site[t], surface.texel_point(t) + vector), 0);
  }
  EXPECT_TRUE(distances.none()) << "distances";
  EXPECT_TRUE(lengths.none()) << "lengths of vectors over distances";
  EXPECT_TRUE(sites_named.none()) << "distances of closest points to the sites named";

  std::size_t stray = 0;
  for (std::size_t t = 0; t < texels; ++t)
    if (surface.texel_faces()[t] == kNone)
      stray += !std::isnan(map.distance[t]) || !std::isnan(map.vector[t][0]) || map.site[t] != kNone ||
               map.site_type[t] != SiteType::none;
  EXPECT_EQ(stray, 0u) << "values where no face owns the texel";
}

void expect_closest_points(const Sites& sites, const std::vector<Vec3>& queries,
                           const std::vector<ClosestPoint>& closest, const std::vector<double>& expected,
                           double tolerance) {
  ASSERT_EQ(closest.size(), queries.size());
  ASSERT_EQ(expected.size(), queries.size());
  Disagreements distances(tolerance), lengths(tolerance), sites_named(tolerance), faces_named(tolerance);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const ClosestPoint& c = closest[i];
    distances.compare(i, c.distance, expected[i]);
    lengths.compare(i, norm(c.point - queries[i]), c.distance);
    sites_named.compare(i, distance_to_site(sites, c.type, c.site, c.point), 0);
    faces_named.compare(i, distance_to_site(sites, SiteType::face, c.face, c.point), 0);
  }
  EXPECT_TRUE(distances.none()) << "distances";
  EXPECT_TRUE(lengths.none()) << "|point - query| against distance";
  EXPECT_TRUE(sites_named.none()) << "distances of closest points to the sites named";
  EXPECT_TRUE(faces_named.none()) << "distances of closest points to the faces named";
}

}  // namespace sdm::test
