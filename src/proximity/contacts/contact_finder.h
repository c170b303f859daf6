// Contacts of two bodies, from their vertices and edges.
#pragma once

#include <sdm/proximity_query.h>

#include <array>
#include <span>
#include <vector>

#include "mesh/similarity.h"
#include "proximity/contacts/contact_patches.h"
#include "proximity/contacts/contact_regions.h"
#include "proximity/contacts/deepest_vertex.h"
#include "proximity/contacts/edge_contacts.h"
#include "proximity/contacts/one_sided.h"
#include "proximity/contacts/surface_point.h"
#include "proximity/exact/near_faces.h"
#include "proximity/shape/posed_body.h"

namespace sdm::contacts {

/// Finds contacts; reuses its memory between calls.
class ContactFinder {
 public:
  using Bodies = std::array<const shape::PosedBody*, 2>;

  /// See ProximityQuery::contacts. `meshes`: of both, in the frame of O1. `to_other`: from the frame of each
  /// body to that of the other. `length`: below this length, the vector to the other body does not determine
  /// the normal. Cost: of the pairs of faces within the margin, and of a few closest points for each contact.
  [[nodiscard]] std::span<const Contact> find(const Bodies& bodies, const exact::MeshPair& meshes,
                                              const std::array<mesh::Similarity, 2>& to_other, double margin,
                                              double length);

 private:
  /// A vertex or a point of an edge that is in contact.
  struct Feature {
    std::uint64_t key = 0;   ///< of what is in contact: a vertex, a part or an edge
    std::uint32_t site = 0;  ///< the vertex or edge
    bool edge = false;
    SurfacePoint point{};
    Support support{};  ///< instead of the closest point, if any
    Box faces{};        ///< a box of the faces around it that are in contact, in the frame of the body
  };
  using Regions = std::span<const ContactRegion>;

  void join_vertices();
  void find_vertices();
  void find_deepest(Regions part);
  void find_each(const ContactRegion& region);
  void find_edges();
  void find_on_edge(std::uint32_t edge, bool a_touches, bool b_touches, double reach);
  void find_support(Feature& feature);
  void add_contacts();
  void add_contact(const Feature& feature);
  void extend_by_star(Box& box, std::uint32_t vertex) const;
  [[nodiscard]] Box box_of(Regions part);

  [[nodiscard]] const shape::Body& on() const { return bodies_[body_]->body(); }
  [[nodiscard]] const shape::Body& other() const { return bodies_[1 - body_]->body(); }

  Bodies bodies_{};
  std::array<mesh::Similarity, 2> to_other_;
  double length_ = 0;
  double size_ = 0;  ///< of the smaller body, in the frame of the other one
  exact::NearFaces near_;

  // Of one body, in the frame of the other.
  int body_ = 0;
  double limit_ = 0;  ///< the margin
  ContactRegions regions_;
  OneSidedVertices vertices_;
  DeepestVertex deepest_;
  EdgeContacts edge_contacts_;
  std::vector<Feature> features_;
  std::vector<Vec3> spokes_;

  // Of both.
  std::vector<Contact> contacts_;
  std::vector<Box> boxes_;    ///< of each contact: the box of the faces around it, in space
  std::vector<Box> bridges_;  ///< of parts without a contact
  ContactPatches patches_;
};

}  // namespace sdm::contacts
