// The results for two bodies, as computed by ProximityQuery for its pair and by MultiBodyQuery for each pair.
#pragma once

#include <sdm/proximity_query.h>

#include <array>
#include <optional>
#include <span>

#include "bodies/contacts/contact_finder.h"
#include "bodies/convex/convex_pair.h"
#include "bodies/convex/difference_hull.h"
#include "bodies/pairs/pair_search.h"
#include "bodies/shape/posed_body.h"
#include "bodies/solids/solid_contacts.h"
#include "bodies/solids/solid_pair.h"
#include "certify/depth/depth_search.h"

namespace sdm::pair {

/// Returns the options. Throws sdm::Error if one is out of range.
inline const ProximityOptions& checked(const ProximityOptions& options) {
  check_options(options);
  return options;
}

using pairs::FacePair, pairs::kNoFaces;

/// Results that make the search in a similar pose shorter.
struct Hints {
  /// The closest faces, or faces that intersect, if the separation is known.
  FacePair closest_faces = kNoFaces;
  FacePair common_faces = kNoFaces;    ///< faces that intersect
  convex::Simplex closest_vertices{};  ///< of two convex solids
};

/// The answers on two bodies in their poses that have been found so far.
struct KnownAnswers : Hints {
  double beyond = -1;                  ///< the surfaces are farther apart than this
  std::optional<bool> intersecting{};  ///< the surfaces
  std::optional<bool> colliding{};
  std::optional<BoundedLength> separation{};
  std::optional<std::optional<BoundedLength>> depth{};

  [[nodiscard]] const Hints& hints() const { return *this; }
  /// Keeps only hints.
  void forget(const Hints& hints) {
    static_cast<Hints&>(*this) = hints;
    beyond = -1;
    intersecting.reset();
    colliding.reset();
    separation.reset();
    depth.reset();
  }
};

/// Results as documented at ProximityQuery, each computed on first use. Memory is reused from pair to pair;
/// results do not depend on earlier pairs.
///
/// The triangles are compared in the frame of O1, points in that of the body that they are measured to; the
/// results are in space.
class PairAnswers {
 public:
  /// `depth_precision`: see ProximityOptions.
  PairAnswers(double contact_margin, std::optional<double> depth_precision)
      : contact_margin_(contact_margin), depth_precision_(depth_precision) {}

  /// Sets the bodies to which the results refer. They must outlive this object and remain unchanged until the
  /// next call.
  ///
  /// `known`: what known() returned for the bodies as they are. `hints`: of a similar pose. These change how
  /// long results take, not the results.
  void begin(const shape::PosedBody& o1, const shape::PosedBody& o2, const KnownAnswers& known);
  void begin(const shape::PosedBody& o1, const shape::PosedBody& o2, const Hints& hints = {});

  /// Whether the surfaces are at most this far apart, > 0; the separation is then known.
  [[nodiscard]] bool surfaces_within(double distance);
  /// Whether the bodies collide or their surfaces are at most this far apart.
  [[nodiscard]] bool within(double distance);
  /// The answers computed so far, but for the contacts.
  [[nodiscard]] const KnownAnswers& known() const { return known_; }

  [[nodiscard]] const BoundedLength& separation();
  [[nodiscard]] bool colliding();
  /// How far apart the bodies of a solid pair are; see solids::are_solid_pair().
  [[nodiscard]] const solids::Relation& relation();
  /// The diagonal of the box of both; of a half-space and another body, that of the other one.
  [[nodiscard]] double size() const;
  [[nodiscard]] const std::optional<BoundedLength>& penetration_depth();
  [[nodiscard]] std::span<const Contact> contacts();
  /// contacts() with another margin. The span is valid until the next call.
  [[nodiscard]] std::span<const Contact> contacts_within(double margin);

 private:
  [[nodiscard]] pairs::MeshPair meshes() const;
  [[nodiscard]] bool boxes_or_balls_apart(double distance) const;
  /// The search for two convex solids; nothing for other bodies.
  [[nodiscard]] std::optional<convex::ConvexPair> convex_pair(const pairs::MeshPair& meshes) const;
  [[nodiscard]] bool find_collision();
  void set_bodies(const shape::PosedBody& o1, const shape::PosedBody& o2);
  [[nodiscard]] const std::array<mesh::Similarity, 2>& to_other();
  /// The error of a computed distance.
  [[nodiscard]] double precision() const;
  bool find_closest(double bound);
  bool take_separation(double bound);
  [[nodiscard]] bool surfaces_intersect();
  [[nodiscard]] std::optional<BoundedLength> depth();

  double contact_margin_;
  std::optional<double> depth_precision_;
  std::array<const shape::PosedBody*, 2> bodies_{};
  std::array<mesh::Similarity, 2> to_other_;  // from the frame of each body to that of the other
  bool first_to_other_known_ = false;         // the first of these is computed when it is needed
  contacts::ContactFinder contact_finder_;
  pairs::PairWorkspace workspace_;
  depth::DepthSearch depth_search_;

  bool solid_pair_ = false;
  convex::ExitWorkspace exit_workspace_;
  std::optional<solids::Relation> relation_;
  solids::SolidContacts solid_contacts_;

  KnownAnswers known_;
  std::optional<std::span<const Contact>> contacts_;
};

}  // namespace sdm::pair
