/// The scenes of the paper's experiments: meshes that move and deform, frame by frame. The frames are
/// bit-identical on every run, for any number of threads.
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>

#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace sdm::scenes {

enum class SceneKind {
  letters,  ///< soft letters E (2.1k triangles) and G (1.6k), 1 high, that collide, deform and separate
  bunnies,  ///< two soft bunnies (2k triangles each) that do the same
  figure,   ///< a human figure (17.2k triangles), 1 high, that walks on the spot in a box of 12 triangles
  crowd,  ///< 100 agents (480 triangles each), 1.75 high, that cross a ground (8.2k triangles) and each other
  tear,   ///< a cloth (4.8k triangles), 1 wide and held at two sides, that a falling ball tears through
  cloth,  ///< a cloth (19.6k triangles), 1 wide, that falls over a ball and folds on itself and the floor
};

struct SceneOptions {
  /// bunnies: the mesh to reduce to 2,000 triangles. Closed or nearly so, of any position and size, with the
  /// y axis up. Empty: the bunny of Debian's glmark2-data.
  std::filesystem::path mesh{};
};

/// A simulation of several bodies. Lengths are in metres, z is up. Only cloths, and the ball that falls on
/// one, are subject to gravity. Contacts are found with closest_points and inside; the agents of the crowd
/// steer by maps to each other.
class Scene {
 public:
  struct Body {
    std::string name;
    Mesh mesh;  ///< in the current frame
    bool moves = true;
    bool tears = false;  ///< its topology changes
    /// How the topology changed from the last frame to this one: apply it to the mesh of the last frame, then
    /// move all vertices.
    MeshEdit edit{};
  };

  /// The first frame. Throws sdm::Error if SceneOptions::mesh cannot be read.
  explicit Scene(SceneKind kind, const SceneOptions& options = {});
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  [[nodiscard]] std::span<const Body> bodies() const;
  /// Seconds between frames.
  [[nodiscard]] double time_step() const;
  /// Advances to the next frame: changes the positions of the moving bodies, and the topology of those that
  /// tear. Cost: about 10 ms; 100 ms for the cloth.
  void advance();

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::scenes
