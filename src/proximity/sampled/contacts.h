// Contacts from the samples inside the other body, or close to it.
#pragma once

#include <sdm/proximity_query.h>

#include <array>
#include <span>
#include <vector>

#include "proximity/sampled/contact_patches.h"
#include "proximity/sampled/local_distances.h"
#include "proximity/shape/posed_body.h"

namespace sdm::sampled {

/// A body with its measured samples.
struct MeasuredBody {
  const shape::PosedBody& body;
  const LocalDistances& distances;  ///< to the other body, in its frame
};

/// Finds contacts; reuses its memory between calls.
class ContactFinder {
 public:
  /// See ProximityQuery::contacts. `length`: below this length, the vector to the other body does not
  /// determine the normal.
  std::span<const Contact> find(const std::array<MeasuredBody, 2>& bodies, double margin, double length);

 private:
  /// The samples of one chart within a block.
  struct Part {
    std::uint32_t chart;
    std::size_t deepest;  ///< index among the measured samples
    Box box;              ///< contains everything that the samples within the margin cover, in the frame of
                          ///< the other body
  };
  void find_parts(const MeasuredBody& body, const mesh::Similarity& measured_in, double margin);
  void add_contacts(const std::array<MeasuredBody, 2>& bodies, int body, double length);

  std::vector<Part> parts_;   ///< of one body
  std::vector<Vec3> points_;  ///< the deepest samples of the parts
  std::vector<Contact> contacts_;
  std::vector<Box> boxes_;  ///< of each contact: the box of its part, extended across the gap
  ContactPatches patches_;
};

}  // namespace sdm::sampled
