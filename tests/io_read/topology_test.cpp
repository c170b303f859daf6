// Sequences whose topology changes: the edits from file to file give the meshes in the files, and keep what
// stays.
#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <fstream>
#include <vector>

#include "edit/random_edits.h"
#include "io_read/sequences.h"
#include "io_read/writers.h"
#include "scenes/scene.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm {
namespace {

using namespace test;
using ::testing::HasSubstr;

/// The corners of the faces that are present, in any order of faces.
std::vector<std::array<Vec3, 3>> faces_of(const Mesh& mesh) {
  std::vector<std::array<Vec3, 3>> faces;
  for (const Triangle& t : mesh.triangles)
    if (!is_removed(t)) {
      std::array<Vec3, 3> face{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
      std::ranges::rotate(face, std::ranges::min_element(face));
      faces.push_back(face);
    }
  std::ranges::sort(faces);
  return faces;
}

struct Topology : ::testing::Test {
  TemporaryFolder folder;
  int written = 0;

  void clear() {
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      std::filesystem::remove(entry);
    written = 0;
  }
  void write(const std::string& contents, const std::string& extension = ".obj") {
    std::ofstream(folder / ("f" + std::to_string(written++) + extension), std::ios::binary) << contents;
  }
  [[nodiscard]] std::string file(std::size_t frame, const std::string& extension = ".obj") const {
    return (folder / ("f" + std::to_string(frame) + extension)).string();
  }
  [[nodiscard]] MeshSequence sequence() const {
    return MeshSequence(folder.path().string(), {.allow_topology = true});
  }
};

/// Reads a frame. Fails unless the change leads from the mesh before to the one of the file.
const TopologyChange& read(MeshSequence& sequence, std::size_t frame, const Mesh& expected) {
  Mesh mesh = sequence.mesh();
  const std::span<const Vec3> positions = sequence.positions(frame);
  const TopologyChange& change = sequence.change();
  EXPECT_EQ(positions.data(), sequence.mesh().positions.data());
  if (!change.replaced) {
    apply(mesh, change.edit);
    EXPECT_EQ(mesh.triangles, sequence.mesh().triangles);
    if (change.none()) mesh.positions.assign(positions.begin(), positions.end());
    EXPECT_EQ(mesh.positions, sequence.mesh().positions);
  }
  EXPECT_EQ(faces_of(sequence.mesh()), faces_of(expected)) << frame;
  return change;
}

// Moving vertices, faces removed, added, put back and torn apart.
TEST_F(Topology, EditsLeadFromFileToFile) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    clear();
    RandomEdits edits(seed, {.defects = false});
    Mesh mesh = ring(10);
    std::vector<Mesh> meshes;
    for (int i = 0; i < 20; ++i) {
      for (Vec3& p : mesh.positions) p = {p[0] + 0.01, p[1] * 1.001, p[2] - 0.003 * p[0]};
      meshes.push_back(mesh);
      Mesh compact = mesh;
      std::erase_if(compact.triangles, is_removed);
      write(obj(compact));
      apply(mesh, edits.next(mesh));
    }
    MeshSequence frames = sequence();
    std::size_t changes = 0;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      const TopologyChange& change = read(frames, i, meshes[i]);
      EXPECT_FALSE(change.replaced);
      changes += !change.none();
      if (i == 0) continue;
      // Faces with the same corners in both files stay.
      std::size_t before = 0, stay = 0;
      for (std::size_t f = 0; f < meshes[i - 1].triangles.size(); ++f) {
        const Triangle& t = meshes[i - 1].triangles[f];
        before += !is_removed(t);
        stay += !is_removed(t) && t == meshes[i].triangles[f];
      }
      EXPECT_LE(change.edit.removed_faces.size(), before - stay);
    }
    EXPECT_GT(changes, 10u);
  }
}

// The frames of the scene refer to copies of vertices at the same position, which part in the next frame.
TEST_F(Topology, ATearKeepsAllFaces) {
  scenes::Scene scene(scenes::SceneKind::tear);
  std::vector<Mesh> meshes;
  for (int i = 0; i < 55; ++i) {
    if (i > 0) scene.advance();
    if (i < 35) continue;
    meshes.push_back(scene.bodies()[0].mesh);
    write_mesh(file(static_cast<std::size_t>(i), ".ply"), meshes.back());
  }
  MeshSequence frames = sequence();
  ASSERT_EQ(frames.frame_count(), 20u);
  std::size_t torn = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const TopologyChange& change = read(frames, i, meshes[i]);
    EXPECT_TRUE(!change.replaced && change.edit.removed_faces.empty() && change.edit.added_faces.empty());
    torn += change.edit.reconnected_faces.size();
    // Faces keep their numbers, and all vertices are those of the scene.
    ASSERT_EQ(frames.mesh().triangles.size(), meshes[i].triangles.size());
    for (std::size_t f = 0; f < meshes[i].triangles.size(); ++f)
      for (int k = 0; k < 3; ++k)
        ASSERT_EQ(frames.mesh().positions[frames.mesh().triangles[f][k]],
                  meshes[i].positions[meshes[i].triangles[f][k]]);
  }
  EXPECT_GT(torn, 100u);
  EXPECT_EQ(inspect(frames.mesh()).boundary_edges, inspect(meshes.back()).boundary_edges);
  // Any frame can follow any other, but a list that becomes shorter has no numbers to follow.
  for (const std::size_t i : {3u, 17u, 0u, 9u})
    EXPECT_EQ(read(frames, i, meshes[i]).replaced, i == 3 || i == 0);
}

TEST_F(Topology, SequencesOfFixedTopologyAreTheSameWithout) {
  Mesh seams = torus(8, 4);
  const Frames positions = frames_of(seams, 4);
  const std::pair<const char*, std::string (*)(const Mesh&)> formats[] = {
      {".obj", obj}, {".ply", ply_text}, {".stl", stl_binary}, {".glb", glb}};
  for (const auto& [extension, contents] : formats) {
    SCOPED_TRACE(extension);
    clear();
    for (const std::vector<Vec3>& frame : positions) {
      seams.positions = frame;
      write(contents(seams), extension);
    }
    MeshSequence fixed(folder.path().string()), frames = sequence();
    EXPECT_TRUE(fixed.change().none());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      EXPECT_TRUE(std::ranges::equal(fixed.positions(i), frames.positions(i)));
      EXPECT_TRUE(frames.change().none());
      EXPECT_EQ(frames.mesh().triangles, fixed.mesh().triangles);
      EXPECT_EQ(frames.mesh().corner_uvs, fixed.mesh().corner_uvs);
    }
  }
}

// Also where the order of the list and the first corner differ.
TEST_F(Topology, FacesStayWhereverTheyAreInTheList) {
  Mesh mesh = moved(ring(10), {1, 0, 0});
  write(obj(mesh));
  for (Vec3& p : mesh.positions) p[2] += 0.25;
  std::ranges::reverse(mesh.triangles);
  for (std::size_t f = 0; f < mesh.triangles.size(); f += 3)
    std::ranges::rotate(mesh.triangles[f], mesh.triangles[f].begin() + 1);
  mesh.triangles.erase(mesh.triangles.begin() + 5, mesh.triangles.begin() + 9);
  write(obj(mesh));
  MeshSequence frames = sequence();
  const TopologyChange& change = read(frames, 1, mesh);
  EXPECT_EQ(change.edit.removed_faces.size(), 4u);
  EXPECT_TRUE(change.edit.added_faces.empty() && change.edit.reconnected_faces.empty() &&
              change.edit.added_vertices.empty());
}

// A quadrilateral that stays keeps its diagonal, although the other one becomes the better one.
TEST_F(Topology, PolygonsThatStayAreNotTriangulatedAgain) {
  const auto quads = [](double x, bool more) {
    std::string text = "v 0 0 0\nv " + std::to_string(1 + x) + " 0 0\nv 1 1 0\nv " + std::to_string(x) +
                       " 1 0\nv 2 0 0\nv 2 1 0\n";
    return text + "f 1 2 3 4\nf 2 5 6 3\n" + (more ? "f 1 5 2\n" : "");
  };
  write(quads(0.25, false));
  write(quads(-0.25, true));
  const Mesh alone = read_mesh(file(1));
  MeshSequence frames = sequence();
  const std::vector<Triangle> before = frames.mesh().triangles;
  (void)frames.positions(1);
  EXPECT_TRUE(frames.change().edit.removed_faces.empty());
  EXPECT_EQ(frames.change().edit.added_faces.size(), 1u);
  EXPECT_TRUE(std::equal(before.begin(), before.end(), frames.mesh().triangles.begin()));
  EXPECT_FALSE(std::equal(before.begin(), before.end(), alone.triangles.begin()));
}

// STL files have no vertices that faces share, and lists that become shorter may have lost any vertex.
TEST_F(Topology, WithoutNumbersWhatIsAtRestStays) {
  for (const bool stl : {true, false}) {
    SCOPED_TRACE(stl);
    clear();
    Mesh mesh = ring(10);
    const std::string extension = stl ? ".stl" : ".obj";
    const auto write_mesh = [&] { write(stl ? stl_text(mesh) : obj(mesh), extension); };
    write_mesh();
    if (stl)
      mesh.triangles.erase(mesh.triangles.begin() + 7);
    else  // without its first vertex
      mesh = [&] {
        Mesh rest{.positions = {mesh.positions.begin() + 1, mesh.positions.end()},
                  .triangles = {},
                  .corner_uvs = {}};
        for (const auto& [a, b, c] : mesh.triangles)
          if (a != 0 && b != 0 && c != 0) rest.triangles.push_back({a - 1, b - 1, c - 1});
        return rest;
      }();
    write_mesh();
    MeshSequence frames = sequence();
    const std::size_t faces = frames.mesh().triangles.size();
    const TopologyChange& change = read(frames, 1, read_mesh(file(1, extension)));
    EXPECT_FALSE(change.replaced);
    EXPECT_EQ(change.edit.removed_faces.size(), faces - mesh.triangles.size());
    EXPECT_TRUE(change.edit.added_faces.empty() && change.edit.added_vertices.empty());
  }
}

TEST_F(Topology, ALargeChangeReplacesTheMesh) {
  write(obj(ring(10)));
  write(obj(sphere(2)));
  write(obj(ring(10)));
  write(obj(joined(ring(10), moved(ring(10), {5, 0, 0}))));
  write(obj(joined(joined(ring(10), moved(ring(10), {5, 0, 0})), moved(sphere(1), {9, 0, 0}))));
  MeshSequence frames = sequence();
  EXPECT_TRUE(frames.change().none());
  EXPECT_TRUE(read(frames, 1, sphere(2)).replaced);
  EXPECT_EQ(frames.mesh().triangles, read_mesh(file(1)).triangles);
  EXPECT_TRUE(read(frames, 2, ring(10)).replaced);
  const TopologyChange& half = read(frames, 3, read_mesh(file(3)));
  EXPECT_FALSE(half.replaced);
  EXPECT_EQ(half.edit.added_faces.size(), ring(10).triangles.size());
  EXPECT_EQ(read(frames, 4, read_mesh(file(4))).edit.added_faces.size(), sphere(1).triangles.size());
}

// Vertices that meet are one, and those that were one part.
TEST_F(Topology, VerticesMeetAndPart) {
  Mesh apart = joined(cube(), moved(cube(), {2.5, 0, 0})),
       together = joined(cube(), moved(cube(), {2, 0, 0}));
  write(obj(apart));
  write(obj(together));  // the lists are the same: vertices that were two stay two
  write(obj(apart));
  MeshSequence two = sequence();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(read(two, i, i == 1 ? together : apart).none());

  clear();
  write(obj(together));
  write(obj(apart));
  write(obj(moved(apart, {1e-9, 0, 0})));
  MeshSequence one = sequence();
  EXPECT_EQ(inspect(one.mesh()).vertices, 12u);
  const TopologyChange& change = read(one, 1, apart);
  EXPECT_EQ(change.edit.added_vertices.size(), 4u);
  EXPECT_FALSE(change.edit.reconnected_faces.empty());
  EXPECT_TRUE(change.edit.removed_faces.empty() && change.edit.added_faces.empty());
  EXPECT_TRUE(inspect(one.mesh()).closed);
  EXPECT_TRUE(read(one, 2, moved(apart, {1e-9, 0, 0})).none());
}

// Of a seam, whose copies differ by rounding from frame to frame.
TEST_F(Topology, SeamsStayClosed) {
  Mesh seam = sphere(1);
  const auto copy = static_cast<std::uint32_t>(seam.positions.size());
  seam.positions.push_back(seam.positions[0]);
  std::ranges::replace(*std::ranges::find_if(seam.triangles, [](const Triangle& t) { return t[0] == 0; }), 0u,
                       copy);
  write(obj(seam));
  seam.positions[copy][0] += 1e-9;
  seam.triangles.pop_back();
  write(obj(seam));
  MeshSequence frames = sequence();
  (void)frames.positions(1);
  EXPECT_TRUE(frames.change().edit.reconnected_faces.empty());
  EXPECT_EQ(inspect(frames.mesh()).boundary_edges, 3u);
}

TEST_F(Topology, FacesOfOnePointAppearWhenTheirCornersPart) {
  const auto mesh = [](double size) {
    Mesh result = joined(cube(), single_triangle());
    for (std::size_t v = 8; v < 11; ++v)
      result.positions[v] = {5 + size * static_cast<double>(v % 2), size * static_cast<double>(v / 10), 0};
    return result;
  };
  write(obj(mesh(0)));
  write(obj(mesh(1)));
  write(obj(mesh(0)));
  write(obj(mesh(0.5)));
  MeshSequence frames = sequence();
  EXPECT_EQ(faces_of(frames.mesh()).size(), 12u);
  EXPECT_EQ(read(frames, 1, mesh(1)).edit.added_faces.size(), 1u);
  (void)frames.positions(2);  // the vertices stay three: the triangle has no area
  EXPECT_TRUE(frames.change().none());
  EXPECT_TRUE(read(frames, 3, mesh(0.5)).none());
}

TEST_F(Topology, FramesThatCannotBeReadAreSkipped) {
  Mesh mesh = ring(10);
  write(obj(mesh));
  write("v 0 0 0\nf 1 2 3\n");
  write("");
  Mesh nan = mesh;
  nan.positions[3][1] = std::nan("");
  write(obj(nan));
  nan.triangles.pop_back();
  write(obj(nan));
  mesh.triangles.resize(mesh.triangles.size() - 3);
  mesh.positions[0][2] += 0.125;
  write(obj(mesh));
  MeshSequence frames = sequence();
  for (std::size_t i = 1; i < 5; ++i) {
    const std::vector<Triangle> before = frames.mesh().triangles;
    try {
      (void)frames.positions(i);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_THAT(error.what(),
                  HasSubstr("frame " + std::to_string(i) + " (f" + std::to_string(i) + ".obj)"));
    }
    EXPECT_EQ(frames.mesh().triangles, before);
  }
  EXPECT_EQ(read(frames, 5, mesh).edit.removed_faces.size(), 3u);
  EXPECT_THROW((void)MeshSequence(folder.path().string()).positions(5), Error);
}

// Polygons that repeat corners, hold many equal ones, or are the same as another.
TEST_F(Topology, StrangePolygons) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n",
                    faces = "f 1 2 3 4\nf 2 1 5\n";
  std::string many = "f";
  for (int i = 0; i < 20000; ++i) many += " 1";
  const std::vector<std::string> more{"", "f 1 1 1\nf 1 1 2\nf 1 2 3 4\n", "f 3 4 1 2\nf 4 3 2 1\n",
                                      many + "\nf 1 2 3 4\n", "f 1 2 2 3 4\nf 1 2 3 4 4\n" + many + "\n"};
  for (const std::string& extra : more) write(vertices + extra + faces);
  MeshSequence frames = sequence();
  for (const std::size_t i : {1u, 2u, 3u, 4u, 0u, 4u, 1u, 3u}) (void)read(frames, i, read_mesh(file(i)));
}

}  // namespace
}  // namespace sdm
