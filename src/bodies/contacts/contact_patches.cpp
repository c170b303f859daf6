#include "bodies/contacts/contact_patches.h"

namespace sdm::contacts {

void ContactPatches::sort(std::vector<Contact>& contacts, std::span<const Box> boxes, double same) {
  groups_.find(boxes, patches_);
  for (std::uint32_t c = 0; c < contacts.size(); ++c) contacts[c].patch = patches_.find(c);
  order_.sort(contacts, same);
}

}  // namespace sdm::contacts
