// Contacts of two bodies, from their vertices and edges.
#pragma once

#include <sdm/proximity_query.h>

#include <array>
#include <span>
#include <vector>

#include "mesh/similarity.h"
#include "proximity/contacts/contact_patches.h"
#include "proximity/contacts/edge_contacts.h"
#include "proximity/shape/posed_body.h"

namespace sdm::contacts {

/// Finds contacts; reuses its memory between calls.
class ContactFinder {
 public:
  using Bodies = std::array<const shape::PosedBody*, 2>;

  /// See ProximityQuery::contacts. `to_other`: from the frame of each body to that of the other. `length`:
  /// below this length, the vector to the other body does not determine the normal. Cost: of the closest
  /// points of the vertices near the other body; all cores if there are many.
  [[nodiscard]] std::span<const Contact> find(const Bodies& bodies,
                                              const std::array<mesh::Similarity, 2>& to_other, double margin,
                                              double length);

 private:
  /// A node of the wide tree, or a leaf, in the frame of the other body.
  struct Part {
    std::uint32_t node = 0;
    double radius = 0;  ///< of a ball about its centre, in points_, that contains it
  };
  /// The closest point of the other body.
  struct Measured {
    double distance = 0;  ///< negative inside
    Vec3 vector{};        ///< to the closest point
    std::uint32_t face = kNone;
    bool at_boundary = true;  ///< of the solid
  };
  /// A vertex or a point of an edge that is in contact.
  struct Feature {
    std::uint64_t key = 0;  ///< of what is in contact: a vertex, a part or an edge
    double distance = 0;
    std::uint32_t point = 0;  ///< index among points_
    std::uint32_t site = 0;   ///< the vertex or edge
    bool edge = false;
    Support support{};  ///< instead of the closest point, if any
  };
  void find_leaves();
  void find_vertices();
  void find_edges();
  void support(Feature& feature);
  void add_contacts();
  void add_contact(const Feature& feature, const Box& faces);
  void add_children(std::uint32_t node);
  void measure(std::size_t first);

  [[nodiscard]] const shape::Body& on() const { return bodies_[body_]->body(); }
  [[nodiscard]] const shape::Body& other() const { return bodies_[1 - body_]->body(); }

  Bodies bodies_{};
  std::array<mesh::Similarity, 2> to_other_;
  double length_ = 0;
  double size_ = 0;  ///< of the smaller body, in the frame of the other one

  // Of one body, in the frame of the other.
  int body_ = 0;
  double limit_ = 0;  ///< the margin
  std::vector<Part> parts_, closer_;
  std::vector<std::uint32_t> leaves_;  ///< that may be in contact
  std::vector<Vec3> points_;
  std::vector<Measured> measured_;       ///< of points_
  std::vector<std::uint32_t> vertices_;  ///< of points_, but for those of edges
  std::vector<std::uint32_t> point_of_;  ///< of each vertex: its point, or kNone
  std::vector<Feature> features_;
  std::vector<Vec3> spokes_;
  EdgeContacts edge_contacts_;

  // Of both.
  std::vector<Contact> contacts_;
  std::vector<Box> boxes_;  ///< of each contact: the box of the faces around it, in space
  ContactPatches patches_;
};

}  // namespace sdm::contacts
