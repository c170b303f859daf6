#include "inside/shape_signs.h"

#include <memory>

#include "core/lazy/unique_number.h"
#include "inside/near_faces.h"

namespace sdm::inside {
namespace {

std::string open_reason(const sites::SitesData& sites) {
  if (sites.is_solid()) return {};
  std::size_t boundary = 0, nonmanifold = 0;
  for (std::size_t e = 0; e < sites.topology.edges.size(); ++e) {
    boundary += sites.topology.edge_faces(e).size() == 1;
    nonmanifold += sites.topology.edge_faces(e).size() > 2;
  }
  if (boundary > 0) return "O2 is open (" + std::to_string(boundary) + " boundary edges)";
  if (nonmanifold > 0)
    return "O2 is not manifold (" + std::to_string(nonmanifold) + " edges of more than two faces)";
  return "O2 is not orientable";
}

}  // namespace

ShapeSigns::ShapeSigns(const sites::SitesData& sites)
    : box(bounds(sites.mesh)),
      clearance(kClearance / sites.frame.scale),
      number(unique_number()),
      why_open(open_reason(sites)),
      sites_(sites) {}

// What follows from the faces alone, not from where they are, stays.
void ShapeSigns::renew() {
  box = bounds(sites_.mesh);
  clearance = kClearance / sites_.frame.scale;
  number = unique_number();
  sides_.outdate();
  winding_.forget();
}

const FaceSides& ShapeSigns::sides() const {
  return sides_.get([this] { return std::make_shared<FaceSides>(sites_); },
                    [](FaceSides& sides) { sides.renew(); });
}
const WindingNumber& ShapeSigns::winding() const {
  return winding_.get([this] { return std::make_shared<WindingNumber>(sites_); });
}
const BoundarySites& ShapeSigns::boundary() const {
  return boundary_.get(
      [this] { return std::make_shared<BoundarySites>(sites_.topology, sites_.mesh.positions.size()); });
}

const ShapeSigns& signs_of(const sites::SitesData& sites) {
  return sites.signs.get([&] { return std::make_shared<ShapeSigns>(sites); },
                         [](ShapeSigns& signs) { signs.renew(); });
}

}  // namespace sdm::inside
