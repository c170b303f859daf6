// Contacts along which two overlapping bodies leave each other.
#pragma once

#include <sdm/proximity_query.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "bodies/contacts/contact_patches.h"
#include "bodies/pair/pair_answers.h"
#include "bodies/shape/posed_body.h"
#include "bodies/solids/convex_patch.h"

namespace sdm::separate {

/// Which of the contacts of two bodies count. The span is valid until the next call.
using ContactFilter =
    std::function<std::span<const Contact>(std::span<const shape::PosedBody>, std::span<const Contact>)>;

/// As ProximityQuery::separating_contacts(), of bodies that collide. Memory is reused from call to call;
/// results do not depend on earlier calls.
class SeparatingContacts {
 public:
  explicit SeparatingContacts(double contact_margin) : contact_margin_(contact_margin) {}

  /// The contacts of bodies that leave each other by `out`. `filter`: of the contacts that they have then;
  /// all, if it is empty. Convex solids do not need it: their contacts are along normals of their faces.
  /// `apart`: of bodies that leave each other together with others, how far apart the nearest of all are
  /// then. If these two are farther apart, they do not have kExitContact, and perhaps no contact.
  void find(const shape::PosedBody& o1, const shape::PosedBody& o2, const SeparatingTranslation& out,
            const ContactFilter& filter, std::optional<double> apart = {});
  /// The contact that kExitContact is, if there is one.
  [[nodiscard]] std::optional<Contact> exit_of(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                               const SeparatingTranslation& out,
                                               std::optional<double> apart = {});
  /// Takes these contacts.
  void assign(std::span<const Contact> contacts) { contacts_.assign(contacts.begin(), contacts.end()); }
  /// Keeps so many of each patch, at least 1. Requires that they are sorted by patch and depth.
  void keep_per_patch(std::size_t most);
  [[nodiscard]] std::span<const Contact> contacts() const { return contacts_; }

 private:
  [[nodiscard]] bool find_of_convex(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                    const SeparatingTranslation& out);
  [[nodiscard]] std::span<const Contact> patch_of(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                                  const SeparatingTranslation& out);
  [[nodiscard]] std::optional<Contact> exit_after(const std::array<shape::PosedBody, 2>& bodies,
                                                  const SeparatingTranslation& out, double max_distance);
  void add_after(std::span<const Contact> contacts, const Vec3& t);
  void sort_after(const std::optional<Contact>& exit, double size);
  void choose(std::span<const Contact> patch, std::size_t most);

  double contact_margin_;
  pair::PairAnswers apart_{0, std::nullopt};
  solids::ConvexPatch patch_;
  contacts::ContactOrder order_;
  std::vector<Contact> contacts_;
  std::vector<double> distances_;
  std::vector<std::uint8_t> chosen_;
};

}  // namespace sdm::separate
