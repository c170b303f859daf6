#include "research/figures/corrections.h"

#include <algorithm>
#include <cmath>

#include "geometry/vec.h"
#include "gl/gl_engine.h"
#include "sites/closest_on_face.h"

namespace sdm::figures {
namespace {

using literal::Corrections;

/// A correction, and what else must change with it.
struct Switch {
  const char* name;
  void (*set)(Corrections&, bool on);
};
constexpr Switch kSwitches[] = {
    {"region walls", [](Corrections& c, bool on) { c.region_walls = on; }},
    {"affine vectors",
     [](Corrections& c, bool on) {
       c.affine_vectors = on;
       c.fragment_vectors &= on;
     }},
    {"fragment vectors",
     [](Corrections& c, bool on) {
       c.fragment_vectors = on;
       c.affine_vectors |= on;
     }},
    {"margins", [](Corrections& c, bool on) { c.margins = on; }},
    {"tiles", [](Corrections& c, bool on) { c.tiles = on; }},
    {"stencil points", [](Corrections& c, bool on) { c.stencil_points = on; }},
};

Variant with(const std::string& prefix, Corrections from, const Switch& which, bool on) {
  which.set(from, on);
  return {prefix + which.name, from};
}

double distance_to_site(const Sites& sites, SiteType type, std::uint32_t site, const Vec3& x) {
  const std::vector<Vec3>& p = sites.mesh().positions;
  if (type == SiteType::face) return sites::closest_on_face(internals(sites), site, x).distance;
  if (type == SiteType::vertex) return norm(x - p[site]);
  const auto [i, j] = sites.edges()[site];
  return norm(closest_on_segment(x, p[i], p[j]) - x);
}

}  // namespace

std::vector<Variant> added_corrections() {
  const Corrections none = Corrections::none();
  std::vector<Variant> result{{"all corrections", {}}, {"as printed", none}};
  for (const Switch& which : kSwitches) result.push_back(with("printed + ", none, which, true));
  Corrections confirmed = none, tiled = none;
  confirmed.confirmation = tiled.tiles = true;
  result.push_back({"printed + confirmation", confirmed});
  result.push_back(with("printed + tiles + ", tiled, kSwitches[0], true));
  result.push_back(with("printed + tiles + ", tiled, kSwitches[1], true));
  return result;
}

std::vector<Variant> removed_corrections() {
  const Corrections all{};
  Corrections drawn = all;
  drawn.confirmation = false;
  std::vector<Variant> result;
  for (const Switch& which : kSwitches) result.push_back(with("all - ", all, which, false));
  result.push_back({"all - confirmation", drawn});
  for (const Switch& which : kSwitches) result.push_back(with("all - confirmation - ", drawn, which, false));
  return result;
}

MapErrors errors_of(const DistanceMap& map, const DistanceMap& reference, const Surface& surface,
                    const Sites& sites) {
  Box box = bounds(surface.mesh());
  extend(box, bounds(sites.mesh()));
  const double unit = diagonal(box), tolerance = gl::kInfo.relative_error * unit;
  MapErrors e;
  for (const std::uint32_t t : surface.sample_texels()) {
    if (map.site_type[t] == SiteType::none) {
      ++e.none;
      e.wrong_texels.push_back(t);
      continue;
    }
    const double expected = std::abs(reference.distance[t]);
    const double error = std::abs(std::abs(map.distance[t]) - expected);
    e.largest = std::max(e.largest, error / unit);
    e.mean += error / unit;
    const Vec3 q = surface.texel_point(t),
               end = q + Vec3{map.vector[t][0], map.vector[t][1], map.vector[t][2]};
    const auto to_site = [&](const Vec3& x) {
      return distance_to_site(sites, map.site_type[t], map.site[t], x);
    };
    if (error > tolerance || to_site(q) > expected + tolerance || to_site(end) > tolerance)
      e.wrong_texels.push_back(t);
  }
  const auto texels = static_cast<double>(surface.sample_texels().size());
  e.mean /= std::max(texels - e.none, 1.0);
  e.wrong = 100 * static_cast<double>(e.wrong_texels.size()) / texels;
  e.none *= 100 / texels;
  return e;
}

}  // namespace sdm::figures
