// The regions of a surface that may be in contact with another body.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bodies/pairs/near_faces.h"
#include "bodies/shape/body.h"
#include "tree/visit.h"

namespace sdm::contacts {

/// A node of the tree of a body.
struct ContactRegion {
  enum class Kind : std::uint8_t {
    part,    ///< in one of shape::contact_parts()
    coarse,  ///< a leaf of large faces, whose vertices are contacts by themselves
    inside,  ///< in a part, inside the other body as a whole
    deep     ///< farther inside the other body than its own size
  };
  Kind kind = Kind::part;
  std::uint32_t node = 0;                       ///< of the binary tree: the part, or the deep node
  std::uint32_t source = 0;                     ///< of the binary tree: the region itself
  std::uint32_t first_leaf = 0, last_leaf = 0;  ///< it has leaves first_leaf ... last_leaf − 1
  std::uint32_t near_face = kNone;  ///< of the other body: the one closest to its centre, if known

  [[nodiscard]] bool is_inside() const { return kind == Kind::inside || kind == Kind::deep; }
};

/// Finds the regions of a body that may be in contact. Memory is reused.
class ContactRegions {
 public:
  /// Finds nodes that cover all of `on` that is inside `other` or within `margin` of it. `to_other`: from the
  /// frame of `on` to that of `other`, in which the margin is. `near`: the faces within the margin, with
  /// sorted leaves; `on` is its surface `side`. Nodes of one part follow each other. Cost: of a closest point
  /// for each region.
  void find(const shape::Body& on, const shape::Body& other, const mesh::Similarity& to_other, double margin,
            const pairs::NearFaces& near, int side);

  [[nodiscard]] std::span<const ContactRegion> regions() const { return regions_; }

 private:
  /// A ball that the surface of the other body does not meet.
  struct OneSided {
    Vec3 centre{};
    double radius = -kInfinity;  ///< unknown
    bool inside = false;
  };
  /// A node of the wide tree, or a leaf, and the side of the other body that it is on.
  struct Node : tree::Place {
    std::uint32_t face = kNone;  ///< of the other body, close to this node or to one above it
    OneSided known{};            ///< about the centre of this node or of one above it

    static Node of(const Node& parent, const tree::WideTree::Node& node, std::uint32_t i) {
      return {Place::of(node, parent.child, i), parent.face, parent.known};
    }
  };
  /// The policy of the search for regions.
  struct Search;
  enum class Position : std::uint8_t { free, inside, undecided };
  /// `ball` contains the node, in the frame of the other body.
  [[nodiscard]] Position find_position(Node& node, const shape::Ball& ball, double depth) const;
  /// Adds the node to the regions, or excludes it; returns whether neither can be said of it as a whole.
  bool divides(Node& node);
  [[nodiscard]] std::uint32_t find_near_face(const shape::ContactPart& node) const;

  const shape::Body *on_ = nullptr, *other_ = nullptr;
  const mesh::Similarity* to_other_ = nullptr;
  double margin_ = 0;
  const pairs::NearFaces* near_ = nullptr;
  int side_ = 0;
  std::vector<Node> stack_;
  std::vector<ContactRegion> regions_;
};

}  // namespace sdm::contacts
