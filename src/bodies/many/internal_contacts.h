// Contacts inside a surface that others continue: at edges between faces in a plane, and between bodies that
// are fixed side by side.
#pragma once

#include <sdm/proximity_query.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bodies/many/near_pairs.h"
#include "bodies/shape/posed_body.h"

namespace sdm::bodies {

/// Tells which contacts are internal. A point of a surface can only push along the normals of the faces
/// around it: where these are flat or concave, or continue in another body, a contact in another direction is
/// one with an edge that a body slides across.
class InternalContacts {
 public:
  /// Finds internal edges of the bodies in their poses, until one moves; also between parts of one body, side
  /// by side. Cost: a sweep over the fixed bodies. Reuses memory.
  void follow(std::span<const shape::PosedBody> bodies, const PairFilter& filter);

  /// The faces around a point, found again for each: memory that is reused.
  struct Around {
    std::vector<std::uint32_t> faces{};
    bool flat = false;  ///< the point is on an edge or a vertex without a convex edge
  };

  [[nodiscard]] bool contains(const Contact& contact, const Sweep::Pair& pair, Around& around) const;
  /// Whether the contact leads out of a body of the pair, the first for 0, into one beside it.
  [[nodiscard]] bool leads_into_neighbour(const Contact& contact, const Sweep::Pair& pair, int side,
                                          Around& around) const;
  /// A body and each of those beside it.
  [[nodiscard]] std::span<const Sweep::Pair> neighbours(std::uint32_t body) const;
  /// Leaves out internal contacts but for kExitContact, and pairs that have no others. The spans are valid
  /// until the next call.
  void leave_out(std::vector<PairContacts>& pairs);

 private:
  /// A point of a body and the direction out of it, in the frame of its mesh.
  struct Exit {
    Vec3 point{}, direction{};
  };

  /// The exit by a contact from a body of a pair, with the faces around it; none on a face without a normal.
  [[nodiscard]] std::optional<Exit> exit_by(const Contact& contact, const shape::PosedBody& body, int side,
                                            Around& around) const;
  [[nodiscard]] static bool off_flat_faces(const shape::PosedBody& body, const Exit& exit,
                                           const Around& around);
  [[nodiscard]] bool into_neighbour(std::uint32_t body, const Exit& exit, const Around& around) const;
  [[nodiscard]] bool covered(std::uint32_t body, std::uint32_t face, const Vec3& point) const;

  std::span<const shape::PosedBody> bodies_;
  std::vector<std::uint32_t> fixed_;
  std::vector<Box> boxes_;  ///< of these
  Sweep sweep_;
  std::vector<Sweep::Pair> neighbours_;  ///< a body and another one fixed beside it, sorted
  std::vector<Contact> external_;        ///< what leave_out() left
  Around around_;
};

/// The contacts of two bodies without those that are internal.
class ExternalContacts {
 public:
  /// After a body has moved.
  void forget() { known_ = false; }
  /// `all`: of the bodies as they are. The span is valid until the next call after forget().
  [[nodiscard]] std::span<const Contact> of(std::span<const shape::PosedBody> bodies,
                                            std::span<const Contact> all);

 private:
  PairFilter filter_{{0, 1}};
  InternalContacts internal_;
  std::vector<PairContacts> pair_;  ///< one, or none without contacts
  bool known_ = false;
};

}  // namespace sdm::bodies
