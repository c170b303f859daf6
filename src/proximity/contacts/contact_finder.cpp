#include "proximity/contacts/contact_finder.h"

#include <algorithm>

#include "core/parallel.h"

namespace sdm::contacts {
namespace {

// With fewer leaves with near faces, of both bodies, handing half of the work to another core takes as long
// as it saves.
constexpr std::size_t kFewLeaves = 64;

}  // namespace

std::span<const Contact> ContactFinder::find(const Bodies& bodies, const exact::MeshPair& meshes,
                                             const std::array<mesh::Similarity, 2>& to_other, double margin,
                                             double length) {
  exact::find_near_faces(meshes, margin / bodies[0]->pose().scale, near_workspace_, near_);
  for (std::vector<std::uint32_t>& leaves : near_.leaves) std::ranges::sort(leaves);
  const auto find_on = [&](int side) { of_[side].find(bodies, to_other, side, margin, length, near_); };
  if (near_.leaves[0].size() + near_.leaves[1].size() <= kFewLeaves)
    find_on(0), find_on(1);
  else
    parallel_invoke([&] { find_on(0); }, [&] { find_on(1); });

  contacts_.clear(), boxes_.clear();
  for (const FeatureContacts& of : of_) {
    contacts_.insert(contacts_.end(), of.contacts().begin(), of.contacts().end());
    boxes_.insert(boxes_.end(), of.boxes().begin(), of.boxes().end());
  }
  for (const FeatureContacts& of : of_) boxes_.insert(boxes_.end(), of.bridges().begin(), of.bridges().end());
  return patches_.sort(contacts_, boxes_);
}

}  // namespace sdm::contacts
