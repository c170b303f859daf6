// Contacts along which two overlapping bodies leave each other.
#pragma once

#include <sdm/proximity_query.h>

#include <functional>
#include <span>
#include <vector>

#include "proximity/pair/pair_answers.h"
#include "query/shape/posed_body.h"

namespace sdm::separate {

/// Which of the contacts of two bodies count. The span is valid until the next call.
using ContactFilter =
    std::function<std::span<const Contact>(std::span<const shape::PosedBody>, std::span<const Contact>)>;

/// As ProximityQuery::separating_contacts(), of bodies that collide and leave each other by `out`. `filter`:
/// of the contacts that they have then; all, if it is empty.
[[nodiscard]] std::vector<Contact> contacts_after(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                                  const SeparatingTranslation& out, double contact_margin,
                                                  const ContactFilter& filter);

/// Keeps so many contacts of each patch, or all if they are no more: the deepest, then always the one that is
/// farthest from those that are kept, of several the deepest. Contacts are sorted by patch and depth, before
/// and after.
void keep_per_patch(std::vector<Contact>& contacts, std::size_t most);

}  // namespace sdm::separate
