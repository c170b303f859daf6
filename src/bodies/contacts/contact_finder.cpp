#include "bodies/contacts/contact_finder.h"

#include <algorithm>

#include "core/cancellation.h"
#include "core/parallel.h"
#include "geometry/vec.h"

namespace sdm::contacts {
namespace {

// Handing part of the work to another core takes as long as it saves, if fewer leaves of both bodies have
// near faces.
constexpr std::size_t kFewLeaves = 64;
// A task with fewer regions or leaves gains no time.
constexpr std::size_t kRegionsOfTask = 16, kLeavesOfTask = 32;

}  // namespace

// Tasks do not depend on the number of cores, so that the results do not either.
void ContactFinder::add_tasks(int side) {
  const std::span<const ContactRegion> regions = candidates_[side].regions();
  for (std::size_t first = 0; first < regions.size();) {
    std::size_t last = std::min(first + kRegionsOfTask, regions.size());
    while (last < regions.size() && regions[last].node == regions[last - 1].node) ++last;
    tasks_.push_back({.side = side, .regions = regions.subspan(first, last - first)});
    first = last;
  }
  const std::span<const std::uint32_t> leaves = candidates_[side].leaves();
  for (std::size_t first = 0; first < leaves.size(); first += kLeavesOfTask)
    tasks_.push_back(
        {.side = side, .leaves = leaves.subspan(first, std::min(kLeavesOfTask, leaves.size() - first))});
}

std::span<const Contact> ContactFinder::find(const Bodies& bodies, const pairs::MeshPair& meshes,
                                             const std::array<mesh::Similarity, 2>& to_other, double margin,
                                             double length) {
  pairs::find_near_faces(meshes, margin / bodies[0]->pose().scale, near_workspace_, near_);
  for (std::vector<std::uint32_t>& leaves : near_.leaves) std::ranges::sort(leaves);
  const bool alone = near_.leaves[0].size() + near_.leaves[1].size() <= kFewLeaves;
  const auto for_each = [&](std::size_t count, const auto& body) {
    const auto range = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        poll();
        body(i);
      }
    };
    if (alone)
      range(0, count);
    else
      parallel_for(count, 1, range);
  };
  for_each(2, [&](std::size_t i) {
    const int side = static_cast<int>(i);
    const shape::Body &on = bodies[side]->body(), &other = bodies[1 - side]->body();
    candidates_[side].find(
        {.bodies = bodies,
         .to_other = to_other,
         .side = side,
         .limit = margin / bodies[1 - side]->pose().scale,
         .length = length,
         .size = std::min(diagonal(other.box()), to_other[side].scale * diagonal(on.box())),
         .near = &near_});
  });
  tasks_.clear();
  for (const int side : {0, 1}) add_tasks(side);
  if (found_.size() < tasks_.size()) found_.resize(tasks_.size());
  for_each(tasks_.size(), [&](std::size_t i) {
    const Task& task = tasks_[i];
    if (task.leaves.empty())
      found_[i].find_at_vertices(candidates_[task.side], task.regions);
    else
      found_[i].find_at_edges(candidates_[task.side], task.leaves);
  });

  contacts_.clear();
  boxes_.clear();
  const std::span<const FeatureContacts> found(found_.data(), tasks_.size());
  for (const FeatureContacts& of : found) {
    contacts_.insert(contacts_.end(), of.contacts().begin(), of.contacts().end());
    boxes_.insert(boxes_.end(), of.boxes().begin(), of.boxes().end());
  }
  for (const FeatureContacts& of : found)
    boxes_.insert(boxes_.end(), of.bridges().begin(), of.bridges().end());
  patches_.sort(contacts_, boxes_, length);
  return contacts_;
}

}  // namespace sdm::contacts
