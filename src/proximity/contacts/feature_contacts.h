// Contacts of the vertices and edges of one body with another.
#pragma once

#include <sdm/proximity_query.h>

#include <array>
#include <span>
#include <vector>

#include "mesh/similarity.h"
#include "proximity/contacts/contact_regions.h"
#include "proximity/contacts/deepest_vertex.h"
#include "proximity/contacts/edge_contacts.h"
#include "proximity/contacts/one_sided.h"
#include "proximity/contacts/surface_point.h"
#include "proximity/exact/near_faces.h"
#include "proximity/shape/posed_body.h"

namespace sdm::contacts {

using Bodies = std::array<const shape::PosedBody*, 2>;

/// Finds them; reuses its memory between calls.
class FeatureContacts {
 public:
  /// Of the features of bodies[side] with the other one; the parameters are those of ContactFinder::find(),
  /// and `near` has sorted leaves. Cost: of a few closest points for each contact.
  void find(const Bodies& bodies, const std::array<mesh::Similarity, 2>& to_other, int side, double margin,
            double length, const exact::NearFaces& near);

  [[nodiscard]] std::span<const Contact> contacts() const { return contacts_; }
  /// Of each contact: the box of the faces around it that are in contact, in space.
  [[nodiscard]] std::span<const Box> boxes() const { return boxes_; }
  /// Boxes of parts that are in contact and have no contact: they connect others.
  [[nodiscard]] std::span<const Box> bridges() const { return bridges_; }

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

  [[nodiscard]] const shape::Body& on() const { return bodies_[side_]->body(); }
  [[nodiscard]] const shape::Body& other() const { return bodies_[1 - side_]->body(); }

  Bodies bodies_{};
  std::array<mesh::Similarity, 2> to_other_;
  const exact::NearFaces* near_ = nullptr;
  int side_ = 0;
  double limit_ = 0;  ///< the margin, in the frame of the other body
  double length_ = 0;
  double size_ = 0;  ///< of the smaller body, in the frame of the other one

  ContactRegions regions_;
  OneSidedVertices vertices_;
  DeepestVertex deepest_;
  EdgeContacts edge_contacts_;
  std::vector<Feature> features_;
  std::vector<Vec3> spokes_;

  std::vector<Contact> contacts_;
  std::vector<Box> boxes_, bridges_;
};

}  // namespace sdm::contacts
