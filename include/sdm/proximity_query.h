/// Two bodies: separation, collision, penetration depth and contacts, each with its bounds; many poses of one
/// shape beside bodies at rest, as of a gripper that looks for a grasp; and when two bodies that move from
/// one pose to another first come into contact.
///
/// Threads: an object is used by one thread at a time; objects and functions that share shapes may be used
/// concurrently.
#pragma once

#include <sdm/bounds.h>
#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/shape.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// A point p of one body that is in contact, and the point q of the other body to which it is pushed. With
/// b(x) the distance of a point x to the other body's surface or, inside a solid, to its boundary, q is
///  - a closest point of the other body, |q − p| = b(p), or
///  - the foot of p on a face that carries the surface around p (see ProximityQuery::contacts). If p is
///    inside, that face is the nearest way out for some x of this surface with b(x) ≥ |q − p|, to 1e-6 of the
///    diagonal of both bodies' box.
/// So depth ≤ ProximityQuery::penetration_depth()->upper for all contacts.
struct Contact {
  Vec3 point1{}, point2{};  ///< on O1 and on O2: p and q, or q and p if p is a point of O2
  /// Unit vector along which moving O1 separates it from O2: point2 − point1 = depth · normal, to rounding,
  /// for depth of either sign; where depth is 0, to 1e-6 of the diagonal of both bodies' box, O2's outward
  /// pseudonormal. Moving O1 by depth along it takes p to q, or q to p. Swapping the two bodies negates it.
  Vec3 normal{};
  double depth = 0;  ///< ±|point2 − point1|, exact; positive if the point in contact is inside the other body
  std::uint32_t patch = 0;  ///< contact patch: contacts on connected parts of the surface share one
  /// point1 on a face of O1 and point2 on a face of O2, to rounding; no face of a primitive shape.
  std::array<SurfacePoint, 2> on{};
  /// Identifies the vertex, the part of a surface or the edge whose contact this is (see
  /// ProximityQuery::contacts): unique among the contacts of a pair, and the same in all frames, so that a
  /// solver can start from the forces of the frame before.
  std::uint64_t id = 0;
};

/// `on` is in two parts, the faces and the barycentric coordinates.
template <>
inline constexpr std::tuple kFields<Contact>{
    Field{"point1", &Contact::point1, "The point of O1."},
    Field{"point2", &Contact::point2, "The point of O2."},
    Field{
        "normal", &Contact::normal,
        "Unit vector along which moving O1 separates it from O2: (point2 - point1) / depth; where depth is "
        "0, "
        "O2's outward normal. Those of separating_contacts() have their own direction and depth, see there."},
    Field{"depth", &Contact::depth,
          "±|point2 - point1|; positive if the point in contact is inside the other body. At most "
          "penetration_depth().upper; of separating_contacts(), at most separating_translation().upper."},
    Field{"patch", &Contact::patch,
          "The patch of the contact: contacts on connected parts of a surface share one."},
    Field{"id", &Contact::id,
          "Identifies what is in contact: unique among the contacts of a pair of bodies, or of their parts, "
          "and the same in all frames."}};

/// How far a body must be moved to leave another one: see ProximityQuery::separating_translation().
struct SeparatingTranslation : BoundedNumber {
  /// The translation of O1; |translation| = value = upper, to rounding. After it the bodies do not collide.
  Vec3 translation{};
};

template <>
inline constexpr std::tuple kFields<SeparatingTranslation>{
    Field{"value", &SeparatingTranslation::value,
          "The length of the translation; the same as the upper bound."},
    Field{
        "certainty", &SeparatingTranslation::certainty,
        "'exact': the bounds are at most 1e-6 of the diagonal of both bodies' box apart, as those of convex "
        "solids are; 'bounded': the shortest translation is between the bounds."},
    Field{"lower", &SeparatingTranslation::lower, "No shorter translation separates the bodies."},
    Field{"upper", &SeparatingTranslation::upper, "The translation is that long, and separates them."},
    Field{"translation", &SeparatingTranslation::translation,
          "Moving O1 by it ends the collision: verified by the exact test. 0 without a collision."}};

/// Options of a ProximityQuery and a MultiBodyQuery.
struct ProximityOptions {
  /// The bounds on the penetration depth are at most this far apart, by default kDepthPrecision of the
  /// diagonal of the smaller body's box, that of its mesh times the scale of the pose; > 0, in units of the
  /// meshes. This includes errors of computed distances, unless they are half of it. Added are, where faces
  /// of a solid that intersects itself nearly coincide, bounds on distances to its boundary. The search
  /// measures at most 2¹⁸ parts of the surfaces: bounds may be farther apart where it ends there.
  std::optional<double> depth_precision{};
  static constexpr double kDepthPrecision = 1e-3;
  /// Contacts are reported for points inside the other body or within this distance of it; ≥ 0, in units of
  /// the meshes.
  double contact_margin = 0;
  /// Leaves out contacts(), and separating_contacts() but for kExitContact, that push a body across an edge
  /// between faces that continue each other, as where it slides over the triangles of a floor: of edges and
  /// vertices whose faces are flat or concave, those that are not along a normal of these. Convex edges keep
  /// theirs. Of a MultiBodyQuery also, of fixed solids side by side, those out of one into the other.
  bool ignore_internal_edges = false;
};

/// depth_precision of a struct.
template <class Struct>
[[nodiscard]] constexpr auto depth_precision_option() {
  return Option{.name = "depth_precision",
                .member = &Struct::depth_precision,
                .text =
                    "Bounds on the penetration depth at most this far apart; by default 1/1000 of the "
                    "smaller body's diagonal.",
                .range = kPositive,
                .unit = "length",
                .value = "EPS"};
}

template <>
inline constexpr auto kOptions<ProximityOptions> = std::tuple{
    depth_precision_option<ProximityOptions>(),
    Option{.name = "contact_margin",
           .member = &ProximityOptions::contact_margin,
           .text = "Also report contacts up to this distance, not only of penetrating parts.",
           .range = {.least = 0},
           .unit = "length",
           .value = "D"},
    Option{.name = "ignore_internal_edges",
           .member = &ProximityOptions::ignore_internal_edges,
           .text =
               "Leave out contacts that push a body across an edge between faces that continue each other, "
               "as where it slides over the triangles of a floor."}};

/// Proximity of two bodies that move and deform, for simulation loops.
///
/// All results are computed from the triangles, those of primitive shapes and of margins from their convex
/// cores and radii: docs/proximity.md says which of these are bounded.
///
/// A body is a shape in a pose: moving it rigidly costs nothing, whatever its size. All results are in space,
/// with both bodies in their poses.
///
/// A closed, orientable body is a solid, with the inside of SignMethod::exact; any other body is a surface
/// without an inside. The depth of a point inside a solid is its distance to the boundary of the solid: the
/// parts of its surface that have the inside on one side only.
///
/// Functions of one body take its number, 0 or 1, and throw sdm::Error for any other.
class SDM_API ProximityQuery {
 public:
  /// The id of the contact of separating_contacts() along the separating translation.
  static constexpr std::uint64_t kExitContact = ~std::uint64_t{0};

  /// Throws sdm::Error as Sites does, and for options that are out of range. Cost: that of the sites of both
  /// bodies.
  ProximityQuery(const Mesh& o1, const Mesh& o2, const ProximityOptions& options = {});
  /// The same for shapes that are there already, or that have an atlas, for maps. Cost: constant.
  ProximityQuery(Shape o1, Shape o2, const ProximityOptions& options = {});
  ~ProximityQuery();
  ProximityQuery(ProximityQuery&&) noexcept;
  ProximityQuery& operator=(ProximityQuery&&) noexcept;

  /// Sets the pose of a body, 0 or 1: a map from the frame of its mesh to space, of a rotation, a uniform
  /// scale and a translation. Initially the identity. The nearest such map is used; throws sdm::Error, and
  /// changes nothing, if `pose` differs from it by more than 1e-5 of the scale, or moves the body beyond what
  /// a mesh can have: coordinates of 1e37. Cost: constant.
  void set_pose(int body, const Transform& pose);
  /// The pose of a body.
  [[nodiscard]] Transform pose(int body) const;

  /// Moves the vertices of the bodies, keeping their triangles and poses. An empty span leaves a body
  /// unchanged. Throws sdm::Error, and changes nothing, for a wrong number of positions, a coordinate that is
  /// not finite, or a body whose Shape is shared with anything else. If there is not enough memory, it also
  /// throws, and changes nothing or leaves the object broken (see sdm/error.h). Cost: that of Sites::refit
  /// and, with an atlas, Surface::refit. The parts of a surface that have one contact each stay those of its
  /// shape before. Neither this nor the queries allocate memory once the bodies have been through similar
  /// poses, unless a solid intersects itself.
  void refit(std::span<const Vec3> o1, std::span<const Vec3> o2);

  /// Changes the mesh of a body, 0 or 1, as Sites::edit and, with an atlas, Surface::edit do, which keeps
  /// faces, texels and their numbers. The ids of its contacts may change. Throws sdm::Error, and changes
  /// nothing, for what they throw for and for a body whose Shape is shared. If there is not enough memory, it
  /// changes nothing or leaves the object broken (see sdm/error.h). All results are those of the edited mesh,
  /// to the bit. Cost: that of new Sites, and of Surface::edit.
  void edit(int body, const MeshEdit& edit);
  /// Replaces the shape of a body, 0 or 1, in the same pose. Cost: constant.
  void replace(int body, Shape shape);

  // Results are computed by the first call after a body has moved. If it throws, as there is not enough
  // memory, the next call computes them.

  /// The smallest distance between the two surfaces, from the triangles: exact, and 0 if they intersect.
  [[nodiscard]] const BoundedLength& separation();
  /// Whether the surfaces intersect or one body is a solid that contains part of the other. Exact, from
  /// the triangles; with a primitive shape or a margin, to rounding.
  [[nodiscard]] bool colliding();
  /// The largest distance from a surface point of either body that lies inside the other to the boundary of
  /// that other body. Exactly 0 if they do not collide, otherwise bounded
  /// (ProximityOptions::depth_precision), with a witness at the depth `value`. Empty if neither body is a
  /// solid.
  [[nodiscard]] const std::optional<BoundedLength>& penetration_depth();
  /// The length of the shortest translation of O1 after which the bodies do not collide, or the infimum of
  /// such lengths: 0, exact, if they do not collide. It is not a path: rings that are linked, but do not
  /// touch, have 0, and the translation out of a closed box leads through its wall.
  ///
  /// penetration_depth() is that of a point, this that of the bodies: where the whole of a surface is pushed
  /// out, not its deepest point alone. So it is at least as large.
  ///
  /// `upper` is the length of a translation that was verified: set_pose(0, Transform::translation(t) *
  /// pose(0)) makes colliding() false. Of two convex solids (see docs/proximity.md) the result is exact, to
  /// 1e-6 of the diagonal of both bodies' box, as `upper` − `lower` is then. For others, `lower` bounds all
  /// translations, by the depths of points of either body and by balls inside of them; it is 0 if neither
  /// body is a solid. Cost: of convex solids, a few hundred searches for extreme vertices. Of others,
  /// penetration_depth(), some hundred collision tests and separations, and at most 4000 searches for a
  /// closest point; at the first call for a shape also some 600 for the balls in it. Single-threaded but for
  /// penetration_depth().
  [[nodiscard]] const SeparatingTranslation& separating_translation();
  /// The contacts of both bodies: none, at the cost of colliding(), if they are farther apart than the
  /// margin. Otherwise one for
  ///  - each vertex that lies inside the other body or within the margin of its surface. Of vertices within
  ///    1/16 of the size of their mesh from each other, in the same node of the tree, only the deepest one
  ///    and the corners of the surface that are as deep, to about 3 degrees, at most eight of their convex
  ///    hull; of a node that is inside by more than its own diameter, only the deepest one;
  ///  - both ends of each part of an edge that lies along a face of the other body, within the margin above
  ///    it, or below it inside the body;
  ///  - each other part of an edge inside the other body or within the margin that reaches no end in contact,
  ///    at the middle of its points closest to the other surface, or at a deep point of the part, if the edge
  ///    is longer than 1/8 of the size of the smaller body and other contacts of the part are much less deep:
  ///    also of an edge that is inside as a whole. Edges are those of the boundary of an open mesh and convex
  ///    ones, not those between faces in a plane, and of edges shorter than 1/16 of the size of the smaller
  ///    body only those without an end in contact.
  /// So a box on a plate has contacts at its corners, and beams that cross where their edges cross.
  ///
  /// Where a surface lies along a face of the other body, to about 3 degrees, the face carries the vertices
  /// and the ends of parts of edges over it, whatever is closest to these points themselves: the side of a
  /// table is closest to a corner of a box that is flush with it, and to the ends of the edges across it. Up
  /// to 1/8 of the size of the smaller body below a solid's face, a face F carries a point p of a vertex or
  /// an edge, with F's outward normal n, if the faces around p contain a point x that is at least as deep:
  ///   b(x) ≥ n·(F − p), with F the nearest way out for x.
  /// Where x is less deep than that, as where the surface is tilted, the contact is at x instead of p, with
  /// the closest point there. Without such an x, F is not the way out of this surface, and the contact is
  /// with the closest point of p. So all contacts have depth ≤ penetration_depth()->upper, and none has a
  /// positive depth in a surface without an inside.
  ///
  /// Contacts of a point inside a body that intersects itself are with the closest point of its boundary, or,
  /// if many faces meet there, with that of its surface. Sorted by patch, the patch with
  /// the deepest contact first, and by decreasing depth within a patch; depths that differ by at most 10⁻⁶ of
  /// the size of both bodies are ordered by id, which does not change from frame to frame. Contacts belong to
  /// the same patch if the boxes of the faces at their vertices and edges intersect: a connected contact
  /// region is never divided. Uses all cores; the result does not depend on how many.
  [[nodiscard]] std::span<const Contact> contacts();

  /// Contacts along which the bodies leave each other, for solvers: where they overlap by much, contacts()
  /// are of single points, and may push in all directions. These are contacts after moving O1 by the
  /// translation t of separating_translation(), moved back by it: that of the closest points then, with the
  /// normal t / |t| and the id kExitContact, and those of contacts() there, with the ids of contacts().
  ///  - point1 is on O1 and point2 on O2, and `on` says where.
  ///  - depth = normal · (point2 − point1), to rounding: how far O1 must be moved along the normal until this
  ///    contact only touches; |point2 − point1| may be more. It is at most normal · t, and so at most
  ///    separating_translation().upper, even if the points are farther apart: those of kExitContact may be on
  ///    a wall beyond the one that O1 leaves by. Contacts with a depth of at most minus the margin are left
  ///    out.
  /// Two convex solids have the patch of a face, an edge or a vertex of each instead: those that touch along
  /// t, or are within 3 degrees of a plane across t; a face with those that continue it in its plane. There
  /// is a contact where a corner of one is over the other one, and where their sides cross, seen along t. All
  /// have the normal t / |t|, points that are above each other along it, and ids that name the vertex or both
  /// edges, which contacts() does not have. Bodies that are convex but for the rounding of vertices, which
  /// Shape::convex() does not recognise, have contacts as all others.
  ///
  /// So t satisfies all of them: normal · t ≥ depth. A step that moves O1 along one normal by what is left of
  /// its depth brings it no farther from t, and so does a projected Gauss–Seidel method over all of them.
  /// Bodies in the same place have contacts, too, in directions that are always the same.
  ///
  /// If the bodies do not collide, these are contacts(). `most_per_patch` ≥ 1: so many contacts of each patch
  /// are kept, the deepest one and those that are farthest apart. Sorted as contacts(). Cost: that of
  /// separating_translation() and of contacts(), and of convex solids little more than the former. The span
  /// is valid until the next call.
  [[nodiscard]] std::span<const Contact> separating_contacts(std::optional<std::size_t> most_per_patch = {});

  /// O1 for 0, O2 for 1; in the frames of their meshes, without the poses. surface() throws sdm::Error if the
  /// shape has no atlas.
  [[nodiscard]] const Surface& surface(int body) const;
  /// As surface(), for any shape.
  [[nodiscard]] const Sites& sites(int body) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Options of a PoseQuery.
struct PoseQueryOptions {
  std::optional<double> depth_precision{};  ///< as that of ProximityOptions
};

template <>
inline constexpr auto kOptions<PoseQueryOptions> = std::tuple{depth_precision_option<PoseQueryOptions>()};

/// Proximity of a shape in many poses to obstacles: other shapes, each in one pose.
///
/// The answers for a pose are those of ProximityQuery with the shape as O1 and each of the obstacles as O2.
/// Each call asks for all poses, on all cores; the results do not depend on how many, nor on the order of the
/// poses. Consecutive poses that are near each other take less time. But for the vector that is returned, no
/// call allocates memory once the shape has been in similar poses, unless a solid intersects itself.
///
/// All calls throw sdm::Error for a pose that ProximityQuery::set_pose refuses, and name one such pose, and
/// if there is not enough memory; values of `results` are then unspecified. Those with `results` also throw
/// for another number of results than of poses.
class SDM_API PoseQuery {
 public:
  /// Any number of obstacles is allowed, including 0. Throws sdm::Error for options that are out of range.
  /// Cost: constant for each obstacle.
  PoseQuery(Shape shape, std::vector<Shape> obstacles, const PoseQueryOptions& options = {});
  /// The same for one obstacle.
  PoseQuery(Shape shape, Shape obstacle, const PoseQueryOptions& options = {});
  ~PoseQuery();
  PoseQuery(PoseQuery&&) noexcept;
  PoseQuery& operator=(PoseQuery&&) noexcept;

  /// Sets the pose of an obstacle, initially the identity, as ProximityQuery::set_pose does. Throws
  /// sdm::Error, and changes nothing, also for an obstacle that does not exist. Cost: constant.
  void set_pose(std::size_t obstacle, const Transform& pose);

  /// Returns whether the shape collides with any obstacle, 1 or 0 for each pose. Exact.
  [[nodiscard]] std::vector<std::uint8_t> colliding(std::span<const Transform> poses);
  /// The same, into `results`.
  void colliding(std::span<const Transform> poses, std::span<std::uint8_t> results);

  /// Returns the smallest distance between the surfaces of the shape and of any obstacle for each pose:
  /// exact, 0 if they intersect; infinite if it is more than `max_distance`, > 0. Throws sdm::Error for any
  /// other maximum distance. A smaller one takes less time.
  [[nodiscard]] std::vector<double> separations(std::span<const Transform> poses,
                                                double max_distance = kInfinity);
  /// The same, into `results`.
  void separations(std::span<const Transform> poses, double max_distance, std::span<double> results);

  /// Returns the largest penetration depth of the shape and any obstacle for each pose, of the pairs of which
  /// one is a solid: exactly 0 without a collision, otherwise bounded; all numbers are NaN if there is no
  /// such pair.
  [[nodiscard]] std::vector<BoundedNumber> penetration_depths(std::span<const Transform> poses);
  /// The same, into `results`.
  void penetration_depths(std::span<const Transform> poses, std::span<BoundedNumber> results);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A motion during the time from 0 to 1: the centre of the mesh's box moves along a straight line, and the
/// body turns about it with constant speed, about one axis, by at most 180°.
struct Motion {
  Transform from{}, to{};  ///< as ProximityQuery::set_pose; with the same scale, to 1e-5

  /// The pose at a time. Throws sdm::Error as set_pose does, and for different scales.
  [[nodiscard]] SDM_API Transform at(double time, const Shape& shape) const;
};

/// The first contact of a motion.
struct TimeOfContact {
  /// The bodies collide at `time`, or are at most the tolerance apart; or, with `bounded`, they may be about
  /// to: a motion that must be free of contact ends at `time` in either case.
  bool contact = false;
  /// The bodies do not touch before this: they are more than half of the tolerance apart. 1 without contact.
  double time = 1;
  /// Between the surfaces at `time`; exact.
  double separation = 0;
  /// bounded: free of contact until `time` for certain, but not decided beyond it. The bodies are
  /// `separation` apart then, more than the tolerance, and the next step that is safe is less than rounding
  /// resolves: the time itself, whose unit is 1e-16, or coordinates in space. Also where two faces took a
  /// million steps.
  Certainty certainty = Certainty::exact;
  /// A point of O1 and a point of O2 that are `separation` apart at `time`, in space, and a face that
  /// contains each.
  std::array<Vec3, 2> witness{};
  std::array<std::uint32_t, 2> faces{kNone, kNone};
  /// Unit vector along which moving O1 separates it from O2: (witness[0] − witness[1]) / separation, or the
  /// opposite where one body contains part of the other at time 0. Nothing if the surfaces intersect then.
  std::optional<Vec3> normal{};
};

template <>
inline constexpr std::tuple kFields<TimeOfContact>{
    Field{
        "contact", &TimeOfContact::contact,
        "Whether the bodies collide at ``time``, or are at most the tolerance apart; or, where ``certainty`` "
        "is 'bounded', may be about to: a motion that must be free of contact ends at ``time`` in either "
        "case."},
    Field{"time", &TimeOfContact::time,
          "In [0, 1]. The bodies do not touch before this: they are more than half of the tolerance apart. 1 "
          "without contact."},
    Field{"separation", &TimeOfContact::separation,
          "The smallest distance between the surfaces at ``time``, in units of space; exact."},
    Field{
        "certainty", &TimeOfContact::certainty,
        "'exact'; or 'bounded': free of contact until ``time`` for certain, but not decided beyond it, as "
        "the "
        "next step that is safe is less than what rounding resolves: of the time, whose unit is 1e-16, or of "
        "coordinates in space. The bodies are ``separation`` apart then, more than the tolerance."},
    Field{"witness", &TimeOfContact::witness,
          "A point of O1 and a point of O2 that are ``separation`` apart at ``time``, in space."},
    Field{"faces", &TimeOfContact::faces, "A face of O1 and one of O2 that contain these points."},
    Field{
        "normal", &TimeOfContact::normal,
        "Unit vector along which moving O1 separates it from O2: (witness[0] - witness[1]) / separation, or "
        "the opposite where one body contains part of the other at time 0; nothing if the surfaces intersect "
        "then."}};

/// Finds the first contact by controlled conservative advancement (Tang, Kim & Manocha 2009): two parts of
/// the bodies, nodes of their trees or faces, that a direction separates need at least the distance along it,
/// divided by the speed along it, to meet. Each pair of parts advances by itself, so bodies that slide along
/// each other take no more steps than those that are far apart. No contact is missed, however thin the bodies
/// and long the motions. Bodies that collide at first have contact at time 0.
///
/// `tolerance` > 0, in units of space; bodies that come closer than it, but not closer than its half, may
/// have contact or not. Where it is less than the rounding of coordinates, results are `bounded`.
///
/// Throws sdm::Error for any other tolerance, and as Motion::at does. Cost: two searches for the closest
/// faces, that of the pairs of nodes that come near each other before the contact, and of a box around the
/// faces of each of these nodes. Single-threaded.
[[nodiscard]] SDM_API TimeOfContact time_of_contact(const Shape& o1, const Motion& motion1, const Shape& o2,
                                                    const Motion& motion2, double tolerance);

}  // namespace sdm
