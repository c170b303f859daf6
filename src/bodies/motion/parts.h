// The parts of a surface whose motion is bounded: boxes around nodes of its tree, and faces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "bodies/motion/divided_motion.h"
#include "sites/sites_data.h"

namespace sdm::motion {

/// The convex hull of one box, or of three points: in the frame of the mesh, relative to the middle of its
/// box.
struct Part {
  std::array<Vec3, 3> point{};     ///< the middle of the box, or the corners of the face
  std::array<double, 3> radius{};  ///< how far the box, or each corner, is from the axis at most, in space
  double from_middle = 0;          ///< how far the part is from the middle at most, in space
  std::size_t points = 1;
  std::array<Vec3, 3> axis{};  ///< of length 1: of the box, or the normal of the face and 0; 0 without area
  Vec3 half{};                 ///< of the sides of the box; 0 for a face
};

/// A surface and its motion.
struct MovingSurface {
  const sites::SitesData& sites;
  const DividedMotion& motion;
};

/// Names a part: a node of the wide tree, or a face.
struct Place {
  std::uint32_t child = 0;   ///< as WideTree has it; of a face, its index
  std::uint32_t source = 0;  ///< the node of the binary tree
  bool face = false;
};

class Parts {
 public:
  explicit Parts(const MovingSurface& surface);

  /// Boxes are fitted when they are needed, at a cost linear in their faces, and kept.
  [[nodiscard]] const Part& at(const Place& place);
  /// The sum of the sides of a box of the tree, in space; 0 for a face.
  [[nodiscard]] double size(const Place& place) const;

  /// Calls put(place) for the children of a node, or the faces of a leaf.
  template <class Put>
  void for_each_child(const Place& place, const Put& put) const {
    if (tree::WideTree::is_leaf(place.child)) {
      for (const std::uint32_t face : sites_.tree.items_of(place.source))
        put(Place{.child = face, .face = true});
      return;
    }
    const tree::WideTree::Node& node = sites_.wide.nodes[place.child];
    for (std::uint32_t i = 0; i < node.count; ++i)
      put(Place{.child = node.child[i], .source = node.source[i]});
  }
  [[nodiscard]] bool empty() const { return sites_.wide.nodes.empty(); }

 private:
  [[nodiscard]] Part face(std::uint32_t index) const;
  [[nodiscard]] Part box_of_tree(std::uint32_t node) const;
  [[nodiscard]] Part fitted(std::span<const std::uint32_t> faces, const Part& box) const;
  [[nodiscard]] Vec3 corner(std::uint32_t face, int i) const {
    return sites_.mesh.positions[sites_.mesh.triangles[face][i]] - motion_.middle();
  }
  [[nodiscard]] double from_axis(const Vec3& p) const;

  const sites::SitesData& sites_;
  const DividedMotion& motion_;
  const double unit_;
  const Vec3 origin_;
  std::unordered_map<std::uint32_t, Part> boxes_;  // of nodes of the binary tree
  Part face_;                                      // the last one
};

}  // namespace sdm::motion
