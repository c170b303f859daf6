/// The scenes of the paper's experiments: meshes that move and deform, frame by frame. Each begins and goes
/// on the same, to the bit, whatever the number of threads.
#pragma once

#include <sdm/mesh.h>

#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace sdm {

enum class SceneKind {
  letters,  ///< E (2.1k triangles) and G (1.6k), soft, 1 high: they collide, deform and part
  bunnies,  ///< two bunnies (2k each), likewise
  figure,   ///< a figure (17.2k), 1 high, that walks on the spot, in a box of 12 triangles
  cloth,    ///< a cloth (19.6k), 1 wide, that falls over a ball and folds on itself and the floor
};

struct SceneOptions {
  /// bunnies: the mesh that is reduced to 2,000 triangles, closed or nearly so, in any place and size, its y
  /// axis up; empty: the one of Debian's glmark2-data.
  std::filesystem::path mesh{};
};

/// A small simulation. Lengths are metres, z is up, and there is no gravity but for the cloth. Contacts are
/// found by closest_points and inside.
class Scene {
 public:
  struct Body {
    std::string name;
    Mesh mesh;  ///< as it is now
    bool moves = true;
  };

  /// The first frame. Throws sdm::Error where the mesh, or the letters' font (DejaVu), cannot be read.
  explicit Scene(SceneKind kind, const SceneOptions& options = {});
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  [[nodiscard]] std::span<const Body> bodies() const;
  /// Seconds between frames.
  [[nodiscard]] double time_step() const;
  /// Goes on to the next frame: the positions of bodies that move. Cost: some 10 ms; of the cloth, 100 ms.
  void advance();

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm
