#include "inside/sign.h"

#include <sdm/error.h>
#include <sdm/sites.h>

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <span>
#include <string>

#include "core/lazy/unique_number.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/spatial_order.h"
#include "inside/inside.h"
#include "inside/near_faces.h"
#include "mesh/validate.h"

namespace sdm {
SignUsed choose_sign(const Sites& sites, SignMethod asked) {
  const sites::SitesData& data = internals(sites);
  const std::string open = data.is_solid() ? std::string() : inside::signs_of(data).why_open;
  switch (asked) {
    case SignMethod::none:
      return {SignMethod::none, "asked for"};
    case SignMethod::winding:
      if (open.empty())
        return {SignMethod::exact, "requested by winding number; O2 is closed and orientable"};
      return {SignMethod::winding, "requested; an estimate, because " + open};
    case SignMethod::side:
      if (open.empty()) return {SignMethod::exact, "requested by side; O2 is closed and orientable"};
      if (!sites.orientable())
        throw Error("the side of O2 is not defined: O2 is not orientable; use sign none, or winding",
                    Remedy::sign_method);
      return {SignMethod::side, "requested; an estimate, because " + open};
    case SignMethod::exact:
      if (!open.empty())
        throw Error("the inside of O2 is not defined: " + open +
                        "; use sign none, or winding or side for an estimate",
                    Remedy::sign_method);
      return {SignMethod::exact, "requested; O2 is closed and orientable"};
    case SignMethod::automatic:
      break;
  }
  if (!open.empty()) return {SignMethod::none, open};
  return {SignMethod::exact, "O2 is closed and orientable"};
}

std::vector<std::uint8_t> inside_flags(const Sites& sites, std::span<const Vec3> queries,
                                       std::span<const ClosestPoint> closest, SignMethod method) try {
  if (queries.size() != closest.size()) throw Error("inside_flags() needs one closest point for each query");
  mesh::validate_queries(queries);
  std::vector<std::uint8_t> result(queries.size());
  const SignMethod used = choose_sign(sites, method).method;
  if (used == SignMethod::none) return result;
  const sites::SitesData& data = internals(sites);
  const inside::InsideTest test(data, used);
  const bool few = queries.size() < data.mesh.triangles.size();
  // Neighbours take over answers, and meet the same parts of the mesh.
  const std::vector<std::uint32_t> order = morton_order(queries, inside::signs_of(data).box);
  parallel_for(queries.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::array<Vec3, inside::kPacket> points;
    std::array<ClosestPoint, inside::kPacket> closest_of;
    for (std::size_t first = begin; first < end; first += inside::kPacket) {
      const std::size_t count = std::min(inside::kPacket, end - first);
      for (std::size_t k = 0; k < count; ++k) {
        points[k] = queries[order[first + k]];
        closest_of[k] = closest[order[first + k]];
      }
      const std::uint32_t flags =
          test(std::span(points).first(count), std::span(closest_of).first(count), few);
      for (std::size_t k = 0; k < count; ++k) result[order[first + k]] = flags >> k & 1u;
    }
  });
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("inside or outside of points");
}

}  // namespace sdm

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

// The boundary and the reason follow from the topology, which stays.
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
