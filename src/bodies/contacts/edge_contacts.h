// The points at which an edge is in contact with a mesh, between its ends.
#pragma once

#include <span>
#include <vector>

#include "bodies/contacts/faces_near_edge.h"
#include "bodies/contacts/support.h"
#include "bodies/contacts/way_out.h"
#include "bodies/shape/body.h"

namespace sdm::contacts {

/// Finds the contacts of one edge after another. Memory is reused.
///
/// A face supports the part of an edge above it or, up to that depth, below it that is parallel to it, but
/// for a small angle, as a box lies on another one: the ends of these parts carry the body. Below it, only if
/// it is the nearest way out for the surface beside the edge (WayOutFinder). Elsewhere, the parts of the edge
/// that are within the margin of the surface, or inside it, are found exactly, to rounding: the distance to a
/// face is convex along the edge, so what is within the margin of a face is an interval, and between two of
/// them the edge is inside or outside as a whole.
class EdgeContacts {
 public:
  /// An edge in the frame of the other body, and whether its ends are in contact themselves.
  struct Edge {
    Vec3 a{}, b{};
    bool a_touches = false, b_touches = false;
    std::span<const Vec3> sides{};  ///< from the edge along the faces beside it
    SurfaceAround around{};
  };
  struct Found {
    double t = 0;                     ///< 0 at a, 1 at b
    Support support{};                ///< if a face supports the edge here
    WayOut way_out{};                 ///< where that is
    std::uint32_t near_face = kNone;  ///< without a support: a face close to it
    std::uint32_t number = 0;         ///< with one: of this end among those of all supported parts
  };
  /// The ends of the supported parts, but for ends of the edge in contact. For each part of the edge in
  /// contact that is not supported and reaches no end in contact, the middle between the first and the last
  /// point that are closest to the surface. `max_depth`: how deep a support may be; 0: none is
  /// looked for. `tolerance`: of depths. Valid until the next call.
  [[nodiscard]] std::span<const Found> find(const Edge& edge, const shape::Body& other, double margin,
                                            double max_depth, double tolerance);

  /// A part of the edge, by the parameter t at its ends.
  struct Part {
    double from, to;
  };
  /// A part of the edge that is in contact as a whole.
  struct InContact : Part {
    bool from_a = false, to_b = false;             ///< whether it begins or ends with an end in contact
    std::uint32_t first_found = 0, end_found = 0;  ///< of what find() found, these are on it
    std::uint32_t near_face = kNone;               ///< one that is close to it
  };
  /// The parts that find() has divided the edge into. Valid until its next call.
  [[nodiscard]] std::span<const InContact> in_contact() const { return in_contact_; }

 private:
  /// The part of the edge within the margin of a face.
  struct Interval {
    double from, to;
    double distance;  ///< the smallest
    double closest;   ///< where it is
    std::uint32_t face;
  };
  /// A part of the edge, and the face that supports it.
  struct SupportedPart {
    double from, to;
    std::uint32_t face;
    double height, rise;  ///< above the plane of the face, at a and along the edge
    [[nodiscard]] double height_at(double t) const { return height + t * rise; }
  };
  /// A part that faces which continue each other support.
  struct JoinedPart {
    double from, to;
    std::size_t last;  ///< the supported part that ends there
  };
  [[nodiscard]] static Part within(const Edge& edge, const sites::SitesData& sites, std::uint32_t face,
                                   double limit, double closest);
  void add_interval(const Edge& edge, const sites::SitesData& sites, std::uint32_t face, double limit);
  void find_intervals(const Edge& edge, const shape::Body& other, double margin);
  void find_intervals_of_many(const Edge& edge, const sites::SitesData& sites,
                              std::span<const std::uint32_t> faces, double limit, double rounding);
  [[nodiscard]] static Part beside_box(const Edge& edge, const sites::SitesData& sites, std::uint32_t face,
                                       double limit);
  [[nodiscard]] bool touches(const Part& part) const;  ///< known faces on all of it
  void add_touching(Part part);
  void find_supports(const Edge& edge, const shape::Body& other, double margin, double max_depth,
                     double tolerance);
  void add_support(const Edge& edge, const shape::Body& other, std::uint32_t face, double margin,
                   double max_depth);
  [[nodiscard]] bool add_end(const Edge& edge, const shape::Body& other, double t, std::uint32_t number,
                             double tolerance);

  FacesNearEdge faces_;
  WayOutFinder way_out_;
  std::vector<Interval> intervals_;
  std::vector<Part> touching_;  ///< parts of the edge that touch known faces, disjoint
  std::vector<SupportedPart> supported_;
  std::vector<JoinedPart> parts_;
  std::vector<Found> found_;
  std::vector<InContact> in_contact_;
};

}  // namespace sdm::contacts
