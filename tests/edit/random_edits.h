// Random edits of meshes.
#pragma once

#include <sdm/mesh_edit.h>

#include <random>

namespace sdm::test {

/// What an edit may consist of, besides faces removed and added.
struct EditKinds {
  bool moves = true, defects = true;  ///< degenerate and duplicate faces added
};

/// Removes a few neighbouring faces, adds some, puts back some that were removed, tears along an edge, or
/// moves vertices.
class RandomEdits {
 public:
  RandomEdits(unsigned seed, const EditKinds& kinds) : kinds_(kinds), random_(seed) {}
  [[nodiscard]] MeshEdit next(const Mesh& mesh);

 private:
  [[nodiscard]] std::size_t below(std::size_t n) { return random_() % n; }
  [[nodiscard]] std::uint32_t present_face(const Mesh& mesh);
  [[nodiscard]] Vec3 offset(double length);
  void remove(const Mesh& mesh, MeshEdit& edit);
  void put_back(MeshEdit& edit);
  void add(const Mesh& mesh, MeshEdit& edit);
  void tear(const Mesh& mesh, MeshEdit& edit);
  void move(const Mesh& mesh, MeshEdit& edit);
  void add_defects(const Mesh& mesh, MeshEdit& edit);

  EditKinds kinds_;
  std::mt19937 random_;
  std::vector<Triangle> removed_;  ///< and not put back
};

}  // namespace sdm::test
