// Contacts of the vertices and edges of one body with another.
#pragma once

#include <sdm/proximity_query.h>

#include <array>
#include <span>
#include <vector>

#include "bodies/contacts/contact_candidates.h"
#include "bodies/contacts/deepest_vertex.h"
#include "bodies/contacts/edge_contacts.h"
#include "bodies/contacts/surface_point.h"

namespace sdm::contacts {

/// Finds the contacts of features. Memory is reused between calls. What several finders find for parts of the
/// candidates does not depend on their order, so that they may run at once.
class FeatureContacts {
 public:
  /// Finds the contacts at the vertices of some regions, which include all or none of those of a part. Cost:
  /// of a few closest points for each contact.
  void find_at_vertices(ContactCandidates& candidates, std::span<const ContactRegion> regions);
  /// Finds the contacts at the edges of some leaves with near faces.
  void find_at_edges(ContactCandidates& candidates, std::span<const std::uint32_t> leaves);

  [[nodiscard]] std::span<const Contact> contacts() const { return contacts_; }
  /// The box, in space, of the faces in contact around each of the contacts.
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
    Support support{};               ///< instead of the closest point, if any
    std::uint32_t own_face = kNone;  ///< which contains the point, if it is not on the vertex or edge
    Box faces{};  ///< a box of the faces around it that are in contact, in the frame of the body
  };
  /// A corner of the outline of what lies along the other body.
  struct Corner {
    std::uint32_t vertex = 0, site = 0;  ///< its numbers among the regions and in the mesh
    Vec3 offset{};                       ///< from the deepest vertex, in the unit frame
  };
  static constexpr std::size_t kMostCorners = 8;  ///< of a part that have contacts
  using Regions = std::span<const ContactRegion>;

  void start(ContactCandidates& candidates);
  void find_deepest(Regions part);
  void add_deepest(Regions part, const DeepestVertex::Found& deepest, const Box& box);
  void find_corners(Regions part, const DeepestVertex::Found& deepest);
  [[nodiscard]] bool is_corner(std::uint32_t vertex, const std::array<Vec3, 3>& across) const;
  static void keep_hull(std::vector<Corner>& corners, const Vec3& up);
  [[nodiscard]] Vec3 outwards_at(const SurfacePoint& point) const;
  void find_each(const ContactRegion& region);
  void find_on_edge(std::uint32_t edge, bool a_touches, bool b_touches, double max_depth);
  void find_support(Feature& feature);
  [[nodiscard]] EdgeContacts::InContact whole_edge() const;
  void find_inside_edges(const ContactRegion& region);
  void find_on_inside_edge(std::uint32_t edge);
  void deepen(const EdgeContacts::Edge& edge, const EdgeContacts::InContact& part, std::size_t first,
              const Feature& feature);
  void add_contacts();
  void add_contact(const Feature& feature);
  void extend_by_star(Box& box, std::uint32_t vertex) const;
  [[nodiscard]] Box box_of(Regions part);
  [[nodiscard]] double tolerance() const;

  [[nodiscard]] const ContactQuery& query() const { return candidates_->query(); }
  [[nodiscard]] const shape::Body& on() const { return query().on(); }
  [[nodiscard]] const shape::Body& other() const { return query().other(); }
  [[nodiscard]] const mesh::Similarity& to_other() const { return query().to_other[query().side]; }
  [[nodiscard]] const mesh::Similarity& from_other() const { return query().to_other[1 - query().side]; }

  ContactCandidates* candidates_ = nullptr;
  std::uint32_t face_ = kNone;  ///< of the other body: closest to the vertex that was measured last
  DeepestVertex deepest_;
  EdgeContacts edge_contacts_;
  WayOutFinder way_out_;
  std::vector<Feature> features_;
  std::vector<Vec3> spokes_;
  std::vector<Corner> corners_;

  std::vector<Contact> contacts_;
  std::vector<Box> boxes_, bridges_;
};

}  // namespace sdm::contacts
