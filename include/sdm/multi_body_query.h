/// Proximity of many bodies: all pairs, and the distance map of each body to all others.
#pragma once

#include <sdm/bounds.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>
#include <sdm/options.h>
#include <sdm/proximity_query.h>
#include <sdm/shape.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// One of the shapes that a body is made of, and its pose in the frame of the body: a map of a rotation, a
/// uniform scale and a translation.
struct BodyPart {
  Shape shape;
  Transform pose{};
};

/// The parts of a pair of bodies that an answer is of, by their numbers in each body: 0 for one of one shape.
using PartPair = std::array<std::uint32_t, 2>;

/// Which pairs a body takes part in. Two bodies are a pair if at most one of them is fixed, and each one's
/// mask contains a group of the other.
struct BodyFilter {
  bool fixed = false;        ///< it may still be moved, as a door is
  std::uint32_t groups = 1;  ///< a bit for each group that the body belongs to
  std::uint32_t mask = ~0u;  ///< a bit for each group that it meets
};

/// Two bodies that collide.
struct BodyPair {
  std::uint32_t first = kNone, second = kNone;  ///< first < second
  PartPair parts{};                             ///< the first parts that collide
};

/// ProximityQuery::separation() and colliding() of a pair: O1 is `first`, O2 is `second`.
struct PairSeparation {
  std::uint32_t first = kNone, second = kNone;  ///< first < second
  BoundedLength separation{};
  bool colliding = false;
  PartPair parts{};  ///< those that are the separation apart
};

template <>
inline constexpr std::tuple kFields<PairSeparation>{
    Field{"first", &PairSeparation::first, "The body of the lower index."},
    Field{"second", &PairSeparation::second, "The other body."},
    Field{"separation", &PairSeparation::separation, "The distance between them; 0 if they collide."},
    Field{"colliding", &PairSeparation::colliding, "Whether they collide."},
    Field{"parts", &PairSeparation::parts, "The parts that are the separation apart."}};

/// ProximityQuery::penetration_depth() of a pair that collides: O1 is `first`, O2 is `second`.
struct PairDepth {
  std::uint32_t first = kNone, second = kNone;  ///< first < second
  BoundedLength penetration_depth{};
  PartPair parts{};  ///< those whose depth is `value`
};

template <>
inline constexpr std::tuple kFields<PairDepth>{
    Field{"first", &PairDepth::first, "The body of the lower index."},
    Field{"second", &PairDepth::second, "The other body."},
    Field{"penetration_depth", &PairDepth::penetration_depth, "How deep they penetrate."},
    Field{"parts", &PairDepth::parts, "The parts whose depth it is."}};

/// ProximityQuery::separating_translation() of a pair that collides: O1 is `first`, O2 is `second`.
struct PairTranslation {
  std::uint32_t first = kNone, second = kNone;  ///< first < second
  SeparatingTranslation separating_translation{};
};

template <>
inline constexpr std::tuple kFields<PairTranslation>{
    Field{"first", &PairTranslation::first, "The body of the lower index."},
    Field{"second", &PairTranslation::second, "The other body."},
    Field{"separating_translation", &PairTranslation::separating_translation, "The way apart."}};

/// ProximityQuery::contacts() or separating_contacts() of a pair: O1 is `first`, O2 is `second`. Of compound
/// bodies, there is one of these for each pair of parts that has contacts, with patches and ids of its own.
struct PairContacts {
  std::uint32_t first = kNone, second = kNone;  ///< first < second
  std::span<const Contact> contacts{};          ///< at least one
  PartPair parts{};                             ///< those in contact
};

/// The first contact of a pair that moves, as time_of_contact() has it: O1 is `first`, O2 is `second`.
struct PairTimeOfContact {
  std::uint32_t first = kNone, second = kNone;  ///< first < second
  TimeOfContact time_of_contact{};
  PartPair parts{};  ///< those that come into contact first
};

template <>
inline constexpr std::tuple kFields<PairTimeOfContact>{
    Field{"first", &PairTimeOfContact::first, "The body of the lower index."},
    Field{"second", &PairTimeOfContact::second, "The other body."},
    Field{"time_of_contact", &PairTimeOfContact::time_of_contact, "Their first contact."},
    Field{"parts", &PairTimeOfContact::parts, "The parts that come into contact first."}};

/// Options of MultiBodyQuery::time_of_contact().
struct TimeOfContactOptions {
  double until = 1;            ///< the last time, from 0 to 1, at which contacts are looked for
  bool earliest_only = false;  ///< only the pairs with the earliest contact of all
};

template <>
inline constexpr auto kOptions<TimeOfContactOptions> = std::tuple{
    Option{.name = "until",
           .member = &TimeOfContactOptions::until,
           .text = "The last time at which contacts are looked for.",
           .range = {0, 1},
           .value = "T"},
    Option{.name = "earliest_only",
           .member = &TimeOfContactOptions::earliest_only,
           .text = "Only the pairs with the earliest contact of all, usually at the cost of one pair."}};

/// The distance map of one body to all others.
struct NearestMap {
  /// As computed by compute_map with all bodies in their poses, at each texel to the body with the nearest
  /// surface, or to the one with the lowest index if several are equally near. The sign is that of that body
  /// alone: negative inside it if it is closed and orientable.
  DistanceMap map;
  /// The index of that body for each value; kNone where the map has no value.
  std::vector<std::uint32_t> body;
  /// The part of that body for each value, whose sites those of the map are; empty if no body is a compound.
  std::vector<std::uint32_t> part;
};

/// Proximity of bodies that move and deform, each against all others, for simulation loops. A body is a shape
/// in a pose, as in ProximityQuery; many bodies can share a shape. Or it is a *compound* of several shapes
/// that move as one, each with its own pose in the frame of the body: the answers for a pair of bodies are
/// then the smallest separation, the largest depth and all contacts of pairs of their parts, and name these.
/// Parts of a body are no pair, and the inside of a compound is that of each of its parts, not of their
/// union: where parts overlap, a depth is that in one of them.
///
/// Each call computes what it returns, and no more, for the pairs of which a body has moved since the last
/// call. Two bodies that did not move keep their answers, which cost a pass over the list of near pairs.
///
/// Threads: an object is used by one thread at a time, but for const functions, which may run concurrently;
/// objects that share shapes may be used concurrently.
class SDM_API MultiBodyQuery {
 public:
  /// Builds the sites of every body; any number of bodies is allowed, including 0. Throws sdm::Error as Sites
  /// does, naming the body, and for options that are out of range. Cost: that of all sites.
  explicit MultiBodyQuery(std::vector<Mesh> meshes, const ProximityOptions& options = {});
  /// The same for shapes that are there already, or that have an atlas, for maps. Cost: constant for each.
  explicit MultiBodyQuery(std::vector<Shape> shapes, const ProximityOptions& options = {});
  /// The same for bodies of one part or more. Throws sdm::Error, naming the body, also for a body without
  /// parts, and as set_pose() does for their poses.
  explicit MultiBodyQuery(std::vector<std::vector<BodyPart>> bodies, const ProximityOptions& options = {});
  ~MultiBodyQuery();
  MultiBodyQuery(MultiBodyQuery&&) noexcept;
  MultiBodyQuery& operator=(MultiBodyQuery&&) noexcept;

  /// The number of bodies.
  [[nodiscard]] std::size_t size() const;
  /// The number of parts of a body: 1 for a body of one shape. Throws sdm::Error for a body that does not
  /// exist.
  [[nodiscard]] std::size_t part_count(std::size_t body) const;

  /// Sets the pose of a body, as ProximityQuery::set_pose does. Throws sdm::Error, and changes nothing, also
  /// for a body that does not exist. A body that is given the pose that it was given last, to the bit,
  /// does not move. Cost: constant.
  void set_pose(std::size_t body, const Transform& pose);
  /// The same for all bodies: one pose per body.
  void set_poses(std::span<const Transform> poses);
  /// The pose of a body. Throws sdm::Error for a body that does not exist.
  [[nodiscard]] Transform pose(std::size_t body) const;
  /// The map from the frame of the mesh of a part to space. Throws sdm::Error for a body or a part that does
  /// not exist.
  [[nodiscard]] Transform part_pose(std::size_t body, std::size_t part) const;

  /// Moves the vertices of a body, keeping its triangles and its pose. Throws sdm::Error, and changes
  /// nothing, for a body that does not exist, is a compound or whose Shape is shared, a wrong number of
  /// positions, or a coordinate that is not finite or beyond 1e37. If there is not enough memory, it also
  /// throws, and changes nothing or leaves the object broken (see sdm/error.h). Cost: linear.
  void refit(std::size_t body, std::span<const Vec3> positions);
  /// The same for all bodies, on all cores: one entry per body; an empty one leaves the body unchanged.
  void refit(std::span<const std::span<const Vec3>> positions);

  /// Sets which pairs a body takes part in. Throws sdm::Error for a body that does not exist. Cost: that of
  /// the next sweep over all bodies.
  void set_filter(std::size_t body, const BodyFilter& filter);
  /// The filter of a body. Throws sdm::Error for a body that does not exist.
  [[nodiscard]] BodyFilter filter(std::size_t body) const;
  /// Leaves out a pair, as of two links that a joint connects. Throws sdm::Error for a body that does not
  /// exist, and for a body and itself. Cost: linear in the pairs left out, and that of the next sweep.
  void exclude_pair(std::size_t a, std::size_t b);
  /// Takes that back.
  void include_pair(std::size_t a, std::size_t b);

  // The answers of a pair are those of ProximityQuery, to the bit. Lists are sorted by first, then by second
  // body, and valid until a body moves or the same call is made again. If a call throws, as there is not
  // enough memory, the next one computes the answers. Neither the calls nor refit() allocate memory once the
  // bodies have been through similar poses, unless a solid intersects itself. Cost of each: the pairs near
  // the bodies that have moved, by a sweep over the boxes if many have, and of these pairs that of the call
  // of ProximityQuery, the pairs distributed over all cores.

  /// Returns the pairs that collide.
  [[nodiscard]] std::span<const BodyPair> colliding();
  /// Returns the pairs that collide or whose separation is at most `max_distance`, > 0. Throws sdm::Error for
  /// any other.
  [[nodiscard]] std::span<const PairSeparation> separations(double max_distance = kInfinity);
  /// Returns the depths of the pairs that collide and of which one is a solid.
  [[nodiscard]] std::span<const PairDepth> penetration_depths();
  /// Returns the pairs that have contacts, within ProximityOptions::contact_margin; with
  /// ignore_internal_edges, without those that are internal, at the cost of a sweep over the fixed bodies
  /// and the parts of compounds, and of a few tests of inside for each contact with one that has others
  /// beside it.
  [[nodiscard]] std::span<const PairContacts> contacts();
  /// Returns, for each pair that collides, a short translation of its first body after which it does not, and
  /// bounds on the shortest one; of compounds, one for all pairs of their parts together, by the same search
  /// with all of them. It is that of the pair alone: other bodies may be in its way. But with
  /// ignore_internal_edges, where it leads out of a fixed solid into another one that is fixed beside it, it
  /// is one that ends the collision with both, and so on with those beside these: a box that overlaps a tile
  /// by little is moved off the floor, not into the next tile. `lower` is then the largest bound of all
  /// these pairs. Cost: that of ProximityQuery::separating_translation() for each pair of parts that
  /// collides; of compounds, and into other bodies, also some hundred tests of collision and separations of
  /// all parts that take part. With ignore_internal_edges, a motion of a fixed body makes all pairs unknown.
  [[nodiscard]] std::span<const PairTranslation> separating_translations();
  /// Returns the pairs that have contacts along which they leave each other: those that collide after the
  /// translation of separating_translations(), moved back by it, all others as contacts() does. Of compounds,
  /// kExitContact is that of the parts which are closest then. Internal edges are left out as in contacts().
  /// `most_per_patch` ≥ 1, of each pair of parts: as for ProximityQuery::separating_contacts(). Throws
  /// sdm::Error for 0. Cost: that of separating_translations(), and of contacts() once for each pair.
  [[nodiscard]] std::span<const PairContacts> separating_contacts(
      std::optional<std::size_t> most_per_patch = {});
  /// The number of pairs, of parts if there are compounds, whose boxes were within `max_distance` of each
  /// other in the last call of separations().
  [[nodiscard]] std::size_t candidate_pairs() const;

  /// Returns the pairs that come into contact while each body makes its motion, whatever the poses of the
  /// bodies (a compound turns about the centre of the box of all its parts in its frame): one motion per
  /// body, sorted by the time of their first contacts, then by first and second body. Pairs are those of the
  /// filters, and each is by itself: bodies move on after their contacts. To move all of them without a
  /// collision, end all motions at the first time; those that are in contact then have contact at time 0 of
  /// motions from there.
  ///
  /// `tolerance` > 0 and the results are as of sdm::time_of_contact() for each pair, to the bit, but for
  /// pairs whose boxes are apart, which have no contact. None is missed, however thin the bodies and long the
  /// motions. Throws sdm::Error, naming the body, as Motion::at does, and for another number of motions, or a
  /// tolerance or time that is out of range. Cost: a sweep over the boxes around the motions, and that of
  /// time_of_contact() for each pair whose boxes are within the tolerance, but for contacts that are later
  /// than asked for; the pairs distributed over all cores.
  [[nodiscard]] std::vector<PairTimeOfContact> time_of_contact(
      std::span<const Motion> motions, double tolerance, const TimeOfContactOptions& options = {}) const;

  /// The poses of all bodies at a time of their motions, as Motion::at gives them; one motion per body.
  /// Throws sdm::Error as it does, and for another number of motions.
  [[nodiscard]] std::vector<Transform> poses_at(std::span<const Motion> motions, double time) const;

  /// Returns the distances from the texels of a body to the nearest other body, whatever their filters;
  /// texels with none within `max_distance`, > 0, have no value. Throws sdm::Error for any other distance,
  /// for a body that does not exist, is a compound or has no atlas, or if there is not enough memory. Cost:
  /// that of compute_map to each body whose box is nearer than the distances found so far, all cores.
  [[nodiscard]] NearestMap nearest_map(std::size_t body, double max_distance = kInfinity) const;
  /// The same, into `nearest`, whose memory is reused where possible. If it throws, the values of `nearest`
  /// are unspecified.
  void nearest_map(std::size_t body, double max_distance, NearestMap& nearest) const;

  /// The atlas and the sites of a body, or of a part of it, in the frame of its mesh, without the pose. Both
  /// throw sdm::Error for a body or part that does not exist, surface() also for one without an atlas.
  [[nodiscard]] const Surface& surface(std::size_t body, std::size_t part = 0) const;
  /// As surface().
  [[nodiscard]] const Sites& sites(std::size_t body, std::size_t part = 0) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the distance from each vertex of a body, those of its parts one after another, to the nearest
/// other body, signed as in nearest_map; NaN where none is within max_distance. Throws sdm::Error for a body
/// that does not exist. Cost: that of closest_points to every other body.
[[nodiscard]] SDM_API std::vector<float> nearest_distances_at_vertices(const MultiBodyQuery& bodies,
                                                                       std::size_t body, double max_distance);

}  // namespace sdm
