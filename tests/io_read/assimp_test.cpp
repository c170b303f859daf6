// Agreement with an independent reader, on installed files and on files of the tests.
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>
#include <sdm/mesh_files.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <vector>

#include "geometry/vec.h"
#include "io_read/writers.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm {
namespace {

// The corners of all triangles, in single precision.
std::vector<Vec3f> corners_by_assimp(const std::filesystem::path& file) {
  Assimp::Importer importer;
  // For 3DS files assimp adds a transform from z up to y up; other formats keep the axes of the file.
  unsigned steps = aiProcess_Triangulate;
  if (file.extension() != ".3ds") steps |= aiProcess_PreTransformVertices;
  const aiScene* scene = importer.ReadFile(file, steps);
  std::vector<Vec3f> corners;
  if (!scene) return corners;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m)
    for (unsigned f = 0; f < scene->mMeshes[m]->mNumFaces; ++f) {
      const aiFace& face = scene->mMeshes[m]->mFaces[f];
      for (unsigned k = 0; face.mNumIndices == 3 && k < 3; ++k) {
        const aiVector3D& p = scene->mMeshes[m]->mVertices[face.mIndices[k]];
        corners.push_back({p.x, p.y, p.z});
      }
    }
  return corners;
}

std::vector<Vec3f> rounded_corners(const Mesh& mesh) {
  std::vector<Vec3f> corners;
  for (const Vec3& p : test::corner_positions(mesh))
    corners.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  return corners;
}

// Up to the rounding of decimals, which need not be correct there, and to the order of the meshes of a file.
void expect_agreement(const std::filesystem::path& file) {
  const Mesh mesh = read_mesh(file);
  std::vector<Vec3f> ours = rounded_corners(mesh), theirs = corners_by_assimp(file);
  ASSERT_EQ(ours.size(), theirs.size()) << file;
  std::sort(ours.begin(), ours.end());
  std::sort(theirs.begin(), theirs.end());
  const double tolerance = 1e-6 * diagonal(bounds(mesh));
  for (std::size_t c = 0; c < ours.size(); ++c) ASSERT_NEAR(ours[c][0], theirs[c][0], tolerance) << file;
  Vec3 our_sum{}, their_sum{};
  for (std::size_t c = 0; c < ours.size(); ++c)
    for (int k = 0; k < 3; ++k) {
      our_sum[k] += ours[c][k];
      their_sum[k] += theirs[c][k];
    }
  EXPECT_LE(norm(our_sum - their_sum), tolerance * static_cast<double>(ours.size()));
}

TEST(Assimp, AgreesOnInstalledFiles) {
  for (const char* name :
       {"bunny.obj", "armadillo.off", "horse.3ds", "elephant.off", "camel.off", "fandisk.off", "hand.off",
        "sphere.stl", "pig.stl", "sphere.ply", "colored_tetra.ply"})
    expect_agreement(test::mesh_file(name));
}

TEST(Assimp, AgreesOnWrittenFiles) {
  const Mesh mesh = test::torus(9, 7);
  const std::string nodes =
      R"([{"children":[1,2],"translation":[10,0,0],"rotation":[0.6,0,0.8,0]},{"mesh":0,"scale":[1,2,3],)"
      R"("rotation":[0.5,0.5,0.5,-0.5]},{"mesh":0,"matrix":[0,1,0,0, 2,0,0,0, 0,0.5,1,0, 3,4,5,1]}])";
  for (const auto& [name, contents] :
       {std::pair{"a.obj", test::obj(mesh)},
        {"a.off", test::off(mesh)},
        {"a.stl", test::stl_text(mesh)},
        {"b.stl", test::stl_binary(mesh)},
        {"a.ply", test::ply_text({mesh.positions, mesh.triangles, {}})},
        {"b.ply", test::ply_binary({mesh.positions, mesh.triangles, {}}, std::endian::little)},
        {"c.ply", test::ply_binary({mesh.positions, mesh.triangles, {}}, std::endian::big)},
        {"a.3ds", test::tds(mesh)},
        {"a.glb", test::glb(test::gltf_json(mesh, nodes, ""), test::gltf_buffer(mesh))}})
    expect_agreement(test::write_file(name, contents));
}

}  // namespace
}  // namespace sdm
