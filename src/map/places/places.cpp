#include <sdm/error.h>
#include <sdm/places.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <new>
#include <tuple>
#include <utility>
#include <vector>

#include "core/disjoint_sets.h"
#include "core/memory.h"
#include "map/places/largest_place.h"
#include "map/places/place_limits.h"
#include "map/statistics/texel_areas.h"

namespace sdm {
namespace {

using map::PlaceLimits;

/// A sample or a vertex beyond a limit.
struct Member {
  std::uint32_t texel, vertex;  ///< one is kNone
  std::uint32_t face;
};

/// The samples beyond the limits, and which of them are connected.
class PlaceSearch {
 public:
  PlaceSearch(const Surface& surface, const DistanceMap& map, std::span<const float> vertex_distances,
              const PlaceLimits& limits)
      : surface_(surface),
        owners_(surface.map_faces()),
        charts_(surface.face_charts()),
        width_(surface.resolution()),
        height_(surface.rows()),
        member_of_texel_(owners_.size(), kNone),
        blocks_((width_ / kBlock + 1) * (height_ / kBlock + std::size_t{1})) {
    for (std::uint32_t texel = 0; texel < owners_.size(); ++texel)
      if (owners_[texel] != kNone)
        if (const int kind = limits.kind(map.distance[texel], owners_[texel]); kind != 0) {
          member_of_texel_[texel] = add(texel, kind);
          if (is_texel(texel)) blocks_[block(texel % width_, texel / width_)] = 1;
        }
    add_vertices(vertex_distances, limits);
    sets_.reset(ids_.size());
    if (ids_.empty()) return;
    unite_texels();
    unite_own_points();
    unite_vertices();
    unite_seams();
  }

  [[nodiscard]] std::size_t size() const { return ids_.size(); }
  [[nodiscard]] Member member(std::size_t m) const {
    if (m < texels()) return {ids_[m], kNone, owners_[ids_[m]]};
    return {kNone, ids_[m], vertex_faces_[m - texels()]};
  }
  [[nodiscard]] std::uint32_t set_of(std::uint32_t member) { return sets_.find(member); }

 private:
  static constexpr double kReach = 1.5;        // texels: some texel of a chart is so near to its border
  static constexpr std::uint32_t kBlock = 16;  // texels along a side

  [[nodiscard]] std::size_t texels() const { return ids_.size() - vertex_faces_.size(); }
  [[nodiscard]] bool is_texel(std::uint32_t sample) const { return sample / width_ < height_; }
  [[nodiscard]] std::size_t block(std::uint32_t x, std::uint32_t y) const {
    return std::size_t{y / kBlock} * (width_ / kBlock + 1) + x / kBlock;
  }

  std::uint32_t add(std::uint32_t id, int kind) {
    ids_.push_back(id);
    kinds_.push_back(kind);
    return static_cast<std::uint32_t>(ids_.size() - 1);
  }

  void add_vertices(std::span<const float> distances, const PlaceLimits& limits) {
    if (distances.empty()) return;
    const auto& triangles = surface_.mesh().triangles;
    for (std::uint32_t face = 0; face < triangles.size(); ++face) {
      if (is_removed(triangles[face])) continue;
      for (const std::uint32_t vertex : triangles[face]) {
        const int kind = limits.kind(distances[vertex], face);
        if (kind == 0) continue;
        if (member_of_vertex_.empty()) member_of_vertex_.assign(distances.size(), kNone);
        if (member_of_vertex_[vertex] != kNone) continue;
        member_of_vertex_[vertex] = add(vertex, kind);
        vertex_faces_.push_back(face);
      }
    }
  }

  void unite(std::uint32_t a, std::uint32_t b) {
    if (kinds_[a] == kinds_[b]) sets_.unite(a, b);
  }

  // Each texel with those of its chart to the left and in the row above.
  void unite_texels() {
    for (std::uint32_t m = 0; m < texels(); ++m) {
      const std::uint32_t texel = ids_[m], x = texel % width_, y = texel / width_;
      if (!is_texel(texel)) break;
      const auto with = [&](std::uint32_t other) {
        const std::uint32_t n = member_of_texel_[other];
        if (n != kNone && charts_[owners_[other]] == charts_[owners_[texel]]) unite(m, n);
      };
      if (x > 0) with(texel - 1);
      if (y == 0) continue;
      with(texel - width_);
      if (x > 0) with(texel - width_ - 1);
      if (x + 1 < width_) with(texel - width_ + 1);
    }
  }

  // Each sample of a face without a texel with the texels around the face, with its vertices, and with those
  // of faces that share one of these.
  void unite_own_points() {
    std::vector<std::array<std::uint32_t, 2>> of_vertex;  // a member there of each side of the limits
    for (std::uint32_t m = 0; m < texels(); ++m) {
      if (is_texel(ids_[m])) continue;
      if (of_vertex.empty()) of_vertex.assign(surface_.mesh().positions.size(), {kNone, kNone});
      const std::uint32_t face = owners_[ids_[m]];
      const auto at = surface_.atlas_corners(face);
      for_each_near(charts_[face], (1.0 / 3) * (at[0] + at[1] + at[2]),
                    [&](std::uint32_t n) { unite(m, n); });
      for (const std::uint32_t vertex : surface_.mesh().triangles[face]) {
        std::uint32_t& other = of_vertex[vertex][kinds_[m] > 0 ? 1 : 0];
        if (other != kNone) unite(m, other);
        other = m;
        if (!member_of_vertex_.empty() && member_of_vertex_[vertex] != kNone)
          unite(m, member_of_vertex_[vertex]);
      }
    }
  }

  // Whether a member may be near a line of the atlas: whether one is in the blocks around it.
  [[nodiscard]] bool any_near(const Vec2& a, const Vec2& b) const {
    const auto range = [&](int k, std::uint32_t size) {
      const double lo = std::min(a[k], b[k]) - kReach, hi = std::max(a[k], b[k]) + kReach;
      const auto at = [&](double c) { return static_cast<std::uint32_t>(std::clamp(c, 0.0, size - 1.0)); };
      return std::pair(at(lo) / kBlock, at(hi) / kBlock);
    };
    const auto [x0, x1] = range(0, width_);
    const auto [y0, y1] = range(1, height_);
    for (std::uint32_t y = y0; y <= y1; ++y)
      for (std::uint32_t x = x0; x <= x1; ++x)
        if (blocks_[block(x * kBlock, y * kBlock)] != 0) return true;
    return false;
  }

  // Calls visit(member) for the texels of a chart around a point of the atlas.
  template <class Visit>
  void for_each_near(std::uint32_t chart, const Vec2& p, const Visit& visit) const {
    const auto first = [](double c) { return static_cast<std::uint32_t>(std::max(0.0, c - kReach)); };
    for (std::uint32_t y = first(p[1]); y < height_ && y + 0.5 < p[1] + kReach; ++y)
      for (std::uint32_t x = first(p[0]); x < width_ && x + 0.5 < p[0] + kReach; ++x) {
        const std::uint32_t texel = y * width_ + x;
        if (member_of_texel_[texel] != kNone && charts_[owners_[texel]] == chart)
          visit(member_of_texel_[texel]);
      }
  }

  // Vertices with the texels around them, and with vertices between which there is no texel.
  void unite_vertices() {
    if (member_of_vertex_.empty()) return;
    const auto& triangles = surface_.mesh().triangles;
    for (std::uint32_t face = 0; face < triangles.size(); ++face) {
      if (charts_[face] == kNone) continue;
      std::array<std::uint32_t, 3> m{};
      for (int k = 0; k < 3; ++k) m[k] = member_of_vertex_[triangles[face][k]];
      if (m == std::array{kNone, kNone, kNone}) continue;
      const auto at = surface_.atlas_corners(face);
      for (int k = 0; k < 3; ++k) {
        if (m[k] == kNone) continue;
        for_each_near(charts_[face], at[k], [&](std::uint32_t n) { unite(m[k], n); });
        const int next = k < 2 ? k + 1 : 0;
        if (m[next] != kNone && std::hypot(at[k][0] - at[next][0], at[k][1] - at[next][1]) < kReach)
          unite(m[k], m[next]);
      }
    }
  }

  /// An edge of a face, from its vertex of the smaller number to the other one.
  struct Side {
    std::array<std::uint32_t, 2> edge;
    std::uint32_t face;
    std::array<Vec2, 2> at;
  };

  // A seam is an edge with several places in the atlas, as one of its ends has. Returns which vertices have.
  [[nodiscard]] std::vector<std::uint8_t> on_seams() const {
    const auto& triangles = surface_.mesh().triangles;
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    std::vector<std::array<float, 2>> first(surface_.mesh().positions.size(), {kNan, kNan});
    std::vector<std::uint8_t> several(first.size());
    for (std::uint32_t face = 0; face < triangles.size(); ++face) {
      if (charts_[face] == kNone) continue;
      const auto at = surface_.atlas_corners(face);
      for (int k = 0; k < 3; ++k) {
        constexpr double kSame = 0.1;  // texels; an atlas has a gutter, or one texel at least
        auto& place = first[triangles[face][k]];
        if (std::isnan(place[0]))
          place = {static_cast<float>(at[k][0]), static_cast<float>(at[k][1])};
        else if (std::hypot(at[k][0] - place[0], at[k][1] - place[1]) > kSame)
          several[triangles[face][k]] = 1;
      }
    }
    return several;
  }

  [[nodiscard]] std::vector<Side> sides_of_seams() const {
    const auto& triangles = surface_.mesh().triangles;
    const std::vector<std::uint8_t> several = on_seams();
    std::vector<Side> sides;
    for (std::uint32_t face = 0; face < triangles.size(); ++face) {
      if (charts_[face] == kNone) continue;
      const Triangle& t = triangles[face];
      for (int k = 0; k < 3; ++k) {
        const int next = k < 2 ? k + 1 : 0;
        if (several[t[k]] == 0 && several[t[next]] == 0) continue;
        const auto at = surface_.atlas_corners(face);
        if (!any_near(at[k], at[next])) continue;
        if (t[k] < t[next])
          sides.push_back({{t[k], t[next]}, face, {at[k], at[next]}});
        else
          sides.push_back({{t[next], t[k]}, face, {at[next], at[k]}});
      }
    }
    std::ranges::stable_sort(sides, {}, &Side::edge);
    return sides;
  }

  void unite_seams() {
    const std::vector<Side> sides = sides_of_seams();
    for (std::size_t i = 1; i < sides.size(); ++i)
      if (sides[i - 1].edge == sides[i].edge) unite_across(sides[i - 1], sides[i]);
  }

  // Both sides have the same members, up to rounding, at points of the edge a texel apart.
  void unite_across(const Side& a, const Side& b) {
    const auto texels = [](const Side& s) {
      return std::hypot(s.at[1][0] - s.at[0][0], s.at[1][1] - s.at[0][1]);
    };
    const auto steps = static_cast<std::size_t>(std::ceil(std::max({1.0, texels(a), texels(b)})));
    const auto point = [](const Side& s, double t) {
      return Vec2{s.at[0][0] + t * (s.at[1][0] - s.at[0][0]), s.at[0][1] + t * (s.at[1][1] - s.at[0][1])};
    };
    for (std::size_t i = 0; i <= steps; ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(steps);
      there_.clear();  // one of each kind
      const auto unite_with_kind = [&](std::uint32_t n) {
        const auto other = std::ranges::find(there_, kinds_[n], [&](auto m) { return kinds_[m]; });
        if (other != there_.end()) unite(*other, n);
        return other != there_.end();
      };
      for_each_near(charts_[a.face], point(a, t), [&](std::uint32_t n) {
        if (!unite_with_kind(n)) there_.push_back(n);
      });
      for_each_near(charts_[b.face], point(b, t), [&](std::uint32_t n) { unite_with_kind(n); });
    }
  }

  const Surface& surface_;
  std::span<const std::uint32_t> owners_, charts_;
  std::uint32_t width_, height_;
  std::vector<std::uint32_t> member_of_texel_, member_of_vertex_;
  std::vector<std::uint8_t> blocks_;         ///< 1 with a member
  std::vector<std::uint32_t> ids_;           ///< of members: samples, ascending, then vertices
  std::vector<int> kinds_;                   ///< of members
  std::vector<std::uint32_t> vertex_faces_;  ///< of members that are vertices: one face each
  std::vector<std::uint32_t> there_;         ///< members at a point of a seam
  DisjointSets sets_;
};

/// The number and the area of all samples.
struct Whole {
  std::size_t texels = 0;
  double area = 0;
};

/// Looks at all samples for the limits, too.
Whole whole_of(const Surface& surface, const DistanceMap& map, std::span<const float> vertex_distances,
               std::span<const double> texel_area, PlaceLimits& limits) {
  Whole whole;
  const auto owners = surface.map_faces();
  for (std::size_t texel = 0; texel < owners.size(); ++texel)
    if (owners[texel] != kNone) {
      ++whole.texels;
      whole.area += texel_area[owners[texel]];
      limits.look(map.distance[texel], owners[texel]);
    }
  if (!vertex_distances.empty())
    for (std::uint32_t face = 0; face < surface.mesh().triangles.size(); ++face)
      if (const Triangle& triangle = surface.mesh().triangles[face]; !is_removed(triangle))
        for (const std::uint32_t vertex : triangle) limits.look(vertex_distances[vertex], face);
  return whole;
}

std::vector<Place> places_of(PlaceSearch& search, const Surface& surface, const DistanceMap& map,
                             std::span<const float> vertex_distances, const PlaceLimits& limits,
                             std::span<const double> texel_area) {
  std::vector<Place> places;
  std::vector<std::uint32_t> place_of(search.size(), kNone);  // of each representative
  for (std::uint32_t m = 0; m < search.size(); ++m) {
    const auto [texel, vertex, face] = search.member(m);
    std::uint32_t& number = place_of[search.set_of(m)];
    const double d = texel != kNone ? map.distance[texel] : vertex_distances[vertex];
    if (number == kNone) {
      number = static_cast<std::uint32_t>(places.size());
      places.emplace_back();
    }
    Place& place = places[number];
    if (place.face == kNone ||
        map::excess(d, limits.limits(face)) > map::excess(place.distance, place.limits)) {
      place.distance = d;
      place.face = face;
      place.limits = limits.limits(face);
      place.sample = texel;
      place.point = texel != kNone ? surface.texel_point(texel) : surface.mesh().positions[vertex];
    }
    if (texel != kNone) {
      ++place.samples;
      place.area += texel_area[face];
    }
  }
  return places;
}

}  // namespace

Places find_places(const Surface& surface, const DistanceMap& map, std::span<const float> vertex_distances,
                   const PlacesOptions& options) try {
  if (map.distance.size() != surface.map_faces().size())
    throw Error("the map belongs to another surface: its number of texels differs");
  if (!vertex_distances.empty() && vertex_distances.size() != surface.mesh().positions.size())
    throw Error("find_places() needs one distance for each vertex of the surface's mesh");
  constexpr double kLeastFraction = 1e-5, kLeastTexels = 4;
  const std::vector<double> texel_area = map::texel_areas(surface);
  PlaceLimits limits(map::FaceTolerances(options.tolerance, options.names, options.table), options.accuracy,
                     options.p99_abs);
  const Whole whole = whole_of(surface, map, vertex_distances, texel_area, limits);
  Places result;
  result.limits = limits.of_all();
  result.by_tolerance = limits.by_tolerance();
  if (whole.texels == 0) return result;
  result.least_fraction = std::max(kLeastFraction, kLeastTexels / static_cast<double>(whole.texels));
  PlaceSearch search(surface, map, vertex_distances, limits);
  std::vector<Place> places = places_of(search, surface, map, vertex_distances, limits, texel_area);
  for (Place& place : places) place.fraction = whole.area > 0 ? place.area / whole.area : 0;
  rank_places(std::move(places), result);
  for (Place& place : result.largest) name_group(place, options.names);
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the places of a map");
}

double map::largest_place(const Surface& surface, const DistanceMap& map,
                          std::span<const float> vertex_distances, const Tolerance& tolerance,
                          double accuracy) try {
  const std::vector<double> texel_area = texel_areas(surface);
  PlaceLimits limits(FaceTolerances(tolerance, {}, {}), accuracy, 0);
  const Whole whole = whole_of(surface, map, vertex_distances, texel_area, limits);
  if (tolerance.lower > tolerance.upper) return whole.area;
  if (!limits.by_tolerance()) return 0;
  PlaceSearch search(surface, map, vertex_distances, limits);
  double largest = 0;
  for (const Place& place : places_of(search, surface, map, vertex_distances, limits, texel_area))
    largest = std::max(largest, place.area);
  return largest;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the places of a map");
}

namespace {

// The first of equals stays the first, so that the list depends on nothing else.
void list_largest(std::vector<Place> all, Places& result) {
  std::ranges::stable_sort(all, std::greater(), [](const Place& place) {
    const bool has_value = !std::isnan(place.distance);
    return std::tuple(!place.small, has_value,
                      has_value ? map::excess(place.distance, place.limits) : place.fraction);
  });
  all.resize(std::min(all.size(), Places::kListed));
  result.largest = std::move(all);
}

}  // namespace

void rank_places(std::vector<Place> all, Places& result) {
  for (Place& place : all) {
    place.small = place.fraction < result.least_fraction;
    PlaceTotals& totals = place.small ? result.small : result.large;
    ++totals.count;
    totals.samples += place.samples;
    totals.area += place.area;
    totals.fraction += place.fraction;
  }
  list_largest(std::move(all), result);
}

void name_group(Place& place, std::span<const FaceNames> names) {
  if (place.face == kNone) return;
  for (const FaceNames& kind : names)
    if (const std::uint32_t name = kind.of_face[place.face]; name != kNone) {
      place.kind = kind.kind;
      place.group = kind.names[name];
      return;
    }
}

std::optional<Places> combined_places(std::span<const Places> places, std::span<const double> areas) {
  double all_area = 0;
  for (const double area : areas) all_area += area;
  std::optional<Places> result;
  std::vector<Place> all;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Places& part = places[i];
    if (!part.by_tolerance) continue;
    const double share = all_area > 0 ? areas[i] / all_area : 0;
    if (!result) {
      result.emplace().limits = part.limits;
      result->by_tolerance = true;
    }
    result->least_fraction = std::max(result->least_fraction, share * part.least_fraction);
    for (const auto& [totals, of_part] :
         {std::pair(&result->large, &part.large), std::pair(&result->small, &part.small)}) {
      totals->count += of_part->count;
      totals->samples += of_part->samples;
      totals->area += of_part->area;
      totals->fraction += share * of_part->fraction;
    }
    for (Place place : part.largest) {
      place.fraction *= share;
      all.push_back(std::move(place));
    }
  }
  if (result) list_largest(std::move(all), *result);
  return result;
}

}  // namespace sdm
