#include "mesh/topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <span>
#include <vector>

#include "support/arrays.h"  // IWYU pragma: keep, for EXPECT_EQ
#include "support/shapes.h"

namespace sdm {
namespace {

using Edge = std::array<std::uint32_t, 2>;

// Soups over few vertices: many repeated corners, duplicates and edges of many faces.
std::vector<Triangle> random_soup(std::mt19937& random, std::uint32_t vertices, std::size_t faces) {
  std::uniform_int_distribution<std::uint32_t> vertex(0, vertices - 1);
  std::vector<Triangle> soup(faces);
  for (Triangle& t : soup) t = {vertex(random), vertex(random), vertex(random)};
  return soup;
}

TEST(Topology, AgreesWithBruteForceOnRandomSoups) {
  std::mt19937 random(1);
  for (int round = 0; round < 300; ++round) {
    const std::uint32_t vertices = 3 + round % 12;
    const std::vector<Triangle> soup = random_soup(random, vertices, 1 + round % 40);
    const mesh::Topology topology = mesh::build_topology(vertices, soup);

    std::set<Triangle> seen;
    std::map<Edge, std::vector<std::uint32_t>> incident;
    std::size_t collapsed = 0, duplicates = 0;
    for (std::uint32_t f = 0; f < soup.size(); ++f) {
      Triangle sorted = soup[f];
      std::sort(sorted.begin(), sorted.end());
      const bool is_collapsed = sorted[0] == sorted[1] || sorted[1] == sorted[2];
      const bool is_duplicate = !is_collapsed && !seen.insert(sorted).second;
      collapsed += is_collapsed;
      duplicates += is_duplicate;
      ASSERT_EQ(topology.ignored(f), is_collapsed || is_duplicate);
      if (topology.ignored(f)) continue;
      for (int k = 0; k < 3; ++k) {
        const Edge edge{std::min(soup[f][k], soup[f][(k + 1) % 3]),
                        std::max(soup[f][k], soup[f][(k + 1) % 3])};
        incident[edge].push_back(f);
        ASSERT_EQ(topology.edges[topology.face_edges[f][k]], edge);
      }
    }
    ASSERT_EQ(topology.collapsed_faces, collapsed);
    ASSERT_EQ(topology.duplicate_faces, duplicates);
    ASSERT_EQ(topology.edges.size(), incident.size());
    std::size_t e = 0;
    for (const auto& [edge, faces] : incident) {  // in lexicographic order
      ASSERT_EQ(topology.edges[e], edge);
      const auto found = topology.edge_faces(e++);
      ASSERT_TRUE(std::equal(found.begin(), found.end(), faces.begin(), faces.end()));
    }
  }
}

TEST(Topology, VertexFacesAgreeWithBruteForce) {
  std::mt19937 random(2);
  for (int round = 0; round < 100; ++round) {
    const std::vector<Triangle> soup = random_soup(random, 9, 25);
    const mesh::Topology topology = mesh::build_topology(9, soup);
    const mesh::VertexFaces rows = mesh::vertex_faces(9, soup, topology);
    for (std::uint32_t v = 0; v < 9; ++v) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t f = 0; f < soup.size(); ++f)
        if (!topology.ignored(f) && std::count(soup[f].begin(), soup[f].end(), v)) expected.push_back(f);
      ASSERT_EQ(std::vector(rows.of(v).begin(), rows.of(v).end()), expected);
    }
  }
}

// Whether faces f and g, flipped or not, traverse their common edge in opposite directions.
bool agree(const Triangle& f, bool f_turned, const Triangle& g, bool g_turned, const Edge& edge) {
  const auto forward = [&](const Triangle& t) {
    for (int k = 0; k < 3; ++k)
      if (t[k] == edge[0] && t[(k + 1) % 3] == edge[1]) return true;
    return false;
  };
  return (forward(f) != f_turned) != (forward(g) != g_turned);
}

bool satisfied(const std::vector<Triangle>& soup, const mesh::Topology& topology,
               std::span<const std::uint8_t> turned) {
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    const auto faces = topology.edge_faces(e);
    if (faces.size() == 2 &&
        !agree(soup[faces[0]], turned[faces[0]], soup[faces[1]], turned[faces[1]], topology.edges[e]))
      return false;
  }
  return true;
}

// Some faces of the projective plane with six vertices, turned at random: with most of them, no turning
// satisfies all.
std::vector<Triangle> random_part_of_projective_plane(std::mt19937& random, std::size_t faces) {
  std::vector<Triangle> soup = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1},
                                {1, 2, 4}, {2, 3, 5}, {3, 4, 1}, {4, 5, 2}, {5, 1, 3}};
  std::shuffle(soup.begin(), soup.end(), random);
  soup.resize(faces);
  for (Triangle& t : soup)
    if (random() % 2) std::swap(t[0], t[1]);
  return soup;
}

TEST(Orient, FindsAnOrientationExactlyIfOneExists) {
  std::mt19937 random(3);
  int orientable = 0, not_orientable = 0;
  for (int round = 0; round < 400; ++round) {
    const std::vector<Triangle> soup =
        round % 2 ? random_soup(random, 6, 10) : random_part_of_projective_plane(random, 5 + round % 6);
    const mesh::Topology topology = mesh::build_topology(6, soup);
    const mesh::Orientation orientation = orient(soup, topology);
    bool exists = false;
    for (unsigned choice = 0; choice < 1u << soup.size() && !exists; ++choice) {
      std::vector<std::uint8_t> turned(soup.size());
      for (std::size_t f = 0; f < soup.size(); ++f) turned[f] = choice >> f & 1;
      exists = satisfied(soup, topology, turned);
    }
    ASSERT_EQ(orientation.orientable, exists);
    if (exists) {
      ASSERT_TRUE(satisfied(soup, topology, orientation.flipped));
    }
    exists ? ++orientable : ++not_orientable;
  }
  EXPECT_GT(orientable, 20);
  EXPECT_GT(not_orientable, 20);
}

TEST(Orient, FlipsTheFewerFacesOfComponentsJoinedByTwoFaceEdges) {
  std::mt19937 random(4);
  for (int round = 0; round < 200; ++round) {
    const std::vector<Triangle> soup = random_soup(random, 12, 14);
    const mesh::Topology topology = mesh::build_topology(12, soup);
    const mesh::Orientation orientation = orient(soup, topology);
    // Spread the lowest face of each component until nothing changes.
    std::vector<std::uint32_t> lowest(soup.size());
    for (std::uint32_t f = 0; f < soup.size(); ++f) lowest[f] = f;
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t e = 0; e < topology.edges.size(); ++e) {
        const auto faces = topology.edge_faces(e);
        if (faces.size() != 2 || lowest[faces[0]] == lowest[faces[1]]) continue;
        lowest[faces[0]] = lowest[faces[1]] = std::min(lowest[faces[0]], lowest[faces[1]]);
        changed = true;
      }
    }
    std::size_t components = 0;
    std::vector<int> more_kept(soup.size(), 0);  // faces kept less faces turned, of each component
    for (std::uint32_t f = 0; f < soup.size(); ++f) {
      if (topology.ignored(f)) {
        ASSERT_EQ(orientation.component[f], kNone);
        ASSERT_EQ(orientation.flipped[f], 0);
        continue;
      }
      ASSERT_EQ(orientation.component[f], orientation.component[lowest[f]]);
      if (lowest[f] == f) {
        ASSERT_EQ(orientation.component[f], components++);
      }
      more_kept[orientation.component[f]] += orientation.flipped[f] ? -1 : 1;
    }
    ASSERT_EQ(orientation.first_face.size(), components);
    for (const int kept : more_kept) ASSERT_GE(kept, 0);
  }
}

TEST(Orient, RestoresFlippedFaces) {
  Mesh mesh = test::torus(12, 9);
  std::mt19937 random(5);
  std::vector<std::uint8_t> turned(mesh.triangles.size(), 0);
  for (std::size_t f = 1; f < turned.size(); ++f)
    if (random() % 2) {
      turned[f] = 1;
      std::swap(mesh.triangles[f][1], mesh.triangles[f][2]);
    }
  const mesh::Orientation orientation =
      orient(mesh.triangles, mesh::build_topology(mesh.positions.size(), mesh.triangles));
  EXPECT_TRUE(orientation.orientable);
  EXPECT_EQ(orientation.flipped, turned);
}

}  // namespace
}  // namespace sdm
