#include "closest/finish.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "closest/finish.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <bit>

#include "closest/closest_points.h"
#include "closest/point_group.h"
#include "closest/single_point.h"
#include "closest/site_lists.h"
#include "core/nothing_found.h"
#include "geometry/lanes/vec-inl.h"
#include "sites/closest_on_face.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::closest::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace lanes::HWY_NAMESPACE;

constexpr size_t kPacket = sites::ClosestPacket::kSize;
static_assert(kPacket == PointGroup::kPacket);  // winners are stored in whole packets

// Queries and their results.
struct Packet {
  sites::ClosestPacket& found;
  alignas(64) double query[3][kPacket];

  Packet(const Vec3* queries, sites::ClosestPacket& to) : found(to) {
    const Doubles d;
    for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
      Vec x, y, z;
      hn::LoadInterleaved3(d, queries[i].data(), x, y, z);
      hn::Store(x, d, query[0] + i);
      hn::Store(y, d, query[1] + i);
      hn::Store(z, d, query[2] + i);
    }
  }
};

// Calls on(query, from) for each vector of a packet that contains one of `lanes`. It sets from = query −
// closest point and returns the mask of queries in the site's region. Stores the closest points of `lanes`,
// and returns the lanes whose queries are in the region.
template <class On>
HWY_INLINE uint32_t for_lanes(Packet& p, uint32_t lanes, const On& on) {
  const Doubles d;
  const uint32_t all = (1u << hn::Lanes(d)) - 1;
  uint32_t inside = 0;
  for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    const uint8_t here = static_cast<uint8_t>(lanes >> i & all);
    if (here == 0) continue;
    const Vec3v query{hn::Load(d, p.query[0] + i), hn::Load(d, p.query[1] + i), hn::Load(d, p.query[2] + i)};
    Vec3v from;
    const auto mask = on(query, from);
    const uint8_t bits[8] = {here};
    const auto keep = hn::LoadMaskBits(d, bits);
    // Relative to the rounded closest point, so that a query on the mesh has distance 0.
    const auto to_point = [&](Vec q, Vec f) HWY_ATTR { return hn::Sub(hn::Sub(q, f), q); };
    const Vec x = to_point(query.x, from.x), y = to_point(query.y, from.y), z = to_point(query.z, from.z);
    const Vec distance = hn::Sqrt(hn::MulAdd(z, z, hn::MulAdd(y, y, hn::Mul(x, x))));
    const auto put = [&](Vec v, double* to)
                         HWY_ATTR { hn::Store(hn::IfThenElse(keep, v, hn::Load(d, to)), d, to); };
    put(x, p.found.vector[0] + i);
    put(y, p.found.vector[1] + i);
    put(z, p.found.vector[2] + i);
    put(distance, p.found.distance + i);
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    inside |= static_cast<uint32_t>(bytes[0]) << i;
  }
  return inside & lanes;
}

// A winner is a site, not a triangle: what is left to verify is that the query lies in its region, where the
// closest point is that of a plane, a line or a vertex. This takes no other region of the faces around it, so
// it is less than a distance from one of them (geometry/lanes/point_triangle-inl.h).

// Above or below the face: on the inner side of its three walls.
uint32_t on_face(const sites::SitesData& sites, uint32_t face, Packet& p, uint32_t lanes) {
  if (sites.sliver[face]) return 0;
  const Triangle& t = sites.mesh.triangles[face];
  const Vec3 &a = sites.mesh.positions[t[0]], &b = sites.mesh.positions[t[1]],
             &c = sites.mesh.positions[t[2]];
  const Vec3 normal = sdm::cross(b - a, c - b);
  const Vec3 wall[3] = {sdm::cross(normal, b - a), sdm::cross(normal, c - b), sdm::cross(normal, a - c)};
  const double offset = sdm::dot(b - a, wall[1]), inverse = 1 / squared_norm(normal);
  return for_lanes(p, lanes, [&](const Vec3v& query, Vec3v& from) HWY_ATTR {
    const Doubles d;
    const Vec3v r = sub(query, splat(a));
    const Vec least = hn::Min(hn::Min(dot(r, splat(wall[0])), dot(r, splat(wall[2]))),
                              hn::Sub(dot(r, splat(wall[1])), hn::Set(d, offset)));
    const Vec h = hn::Mul(dot(r, splat(normal)), hn::Set(d, inverse));
    from = mul(h, splat(normal));
    return hn::Gt(least, hn::Zero(d));
  });
}

// Between the ends of the edge, where neither of its faces is closer.
uint32_t on_edge(const sites::SitesData& sites, uint32_t edge, Packet& p, uint32_t lanes) {
  const auto [a, b] = sites.topology.edges[edge];
  const Vec3 &start = sites.mesh.positions[a], along = sites.mesh.positions[b] - start;
  const std::uint32_t ends = a ^ b;
  const double inverse = 1 / squared_norm(along);
  const auto faces = sites.topology.edge_faces(edge);
  return for_lanes(p, lanes, [&](const Vec3v& query, Vec3v& from) HWY_ATTR {
    const Doubles d;
    const Vec3v r = sub(query, splat(start));
    const Vec t = hn::Mul(dot(r, splat(along)), hn::Set(d, inverse));
    from = sub_mul(r, t, splat(along));
    auto inside = hn::And(hn::Gt(t, hn::Zero(d)), hn::Lt(t, hn::Set(d, 1.0)));
    for (const std::uint32_t face : faces) {
      const Triangle& corners = sites.mesh.triangles[face];
      const Vec3 opposite = sites.mesh.positions[corners[0] ^ corners[1] ^ corners[2] ^ ends] - start;
      const Vec3 inward = opposite - sdm::dot(opposite, along) * inverse * along;
      inside = hn::And(inside, hn::Le(dot(from, splat(inward)), hn::Zero(d)));
    }
    return inside;
  });
}

// Where no edge of the vertex is closer.
uint32_t on_vertex(const sites::SitesData& sites, uint32_t vertex, Packet& p, uint32_t lanes) {
  const Vec3& point = sites.mesh.positions[vertex];
  // Every neighbour follows the vertex in exactly one face of a closed, consistently oriented mesh.
  const int last = sites.consistently_oriented ? 1 : 2;
  return for_lanes(p, lanes, [&](const Vec3v& query, Vec3v& from) HWY_ATTR {
    const Doubles d;
    from = sub(query, splat(point));
    Vec most = hn::Zero(d);
    for (const std::uint32_t face : sites.vertex_faces.of(vertex)) {
      const Triangle& t = sites.mesh.triangles[face];
      const int corner = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
      for (int k = 1; k <= last; ++k)
        most = hn::Max(most, dot(from, splat(sites.mesh.positions[t[(corner + k) % 3]] - point)));
    }
    return hn::Le(most, hn::Zero(d));
  });
}

uint32_t on_site(const sites::SitesData& sites, SiteId site, Packet& p, uint32_t lanes) {
  switch (site.type()) {
    case SiteType::face:
      return on_face(sites, site.site(), p, lanes);
    case SiteType::edge:
      return on_edge(sites, site.site(), p, lanes);
    default:
      return on_vertex(sites, site.site(), p, lanes);
  }
}

// The lanes of a packet that have this winner, as a bit mask.
HWY_INLINE uint32_t lanes_of(const uint32_t* winners, uint32_t winner) {
  const hn::CappedTag<uint32_t, 8> d;
  uint32_t bits = 0;
  for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, hn::Eq(hn::LoadU(d, winners + i), hn::Set(d, winner)), bytes);
    bits |= static_cast<uint32_t>(bytes[0]) << i;
  }
  return bits;
}

// Stores the sites of the winners, for whole packets.
HWY_INLINE void name_sites(const uint32_t* winners, sites::ClosestPacket& found) {
  static_assert(static_cast<int>(SiteType::none) == 255);
  const hn::CappedTag<uint32_t, 8> d;
  const hn::Rebind<int32_t, decltype(d)> di;
  const hn::Rebind<uint8_t, decltype(d)> db;
  for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    const auto winner = hn::LoadU(d, winners + i);
    hn::StoreU(hn::And(winner, hn::Set(d, SiteId::kSiteMask)), d, found.site + i);
    const auto type = hn::BitCast(di, hn::ShiftRight<30>(winner));  // 3: none
    const auto none = hn::Eq(type, hn::Set(di, 3));
    hn::StoreU(hn::DemoteTo(db, hn::IfThenElse(none, hn::Set(di, 255), type)), db,
               reinterpret_cast<uint8_t*>(found.type) + i);
  }
}

// `winners` and `queries` have room for whole packets.
void finish_packet(const sites::SitesData& sites, const uint32_t* winners, const Vec3* queries, size_t count,
                   double max_distance, sites::ClosestPacket& found) {
  Packet p(queries, found);
  name_sites(winners, found);
  found.count = count;
  for (uint32_t pending = (1u << count) - 1; pending != 0;) {
    const SiteId site{winners[std::countr_zero(pending)]};
    const uint32_t lanes = lanes_of(winners, site.packed) & pending;
    pending &= ~lanes;
    uint32_t open = lanes;
    if (site.packed == kNone) {
      if (max_distance == kInfinity) throw_nothing_found();
      continue;
    }
    if (site.packed != SiteId::kUnsettled) open &= ~on_site(sites, site, p, lanes);
    for (; open != 0; open &= open - 1) {
      const auto i = static_cast<size_t>(std::countr_zero(open));
      found.set(i, queries[i],
                site.packed == SiteId::kUnsettled
                    ? closest_point(sites, queries[i], max_distance)
                    : sites::closest_around_face(sites, sites.face_of(site.type(), site.site()), queries[i]));
    }
  }
  if (max_distance < kInfinity)
    for (size_t i = 0; i < count; ++i)
      if (!(found.distance[i] <= max_distance)) found.type[i] = SiteType::none;
}

// `winners` has room for whole packets.
void Finish(const sites::SitesData& sites, std::span<const uint32_t> winners, std::span<const Vec3> queries,
            double max_distance, const sites::ClosestSink& deliver) {
  sites::ClosestPacket closest{};
  const size_t whole = queries.size() / kPacket * kPacket;
  for (size_t i = 0; i < whole; i += kPacket) {
    finish_packet(sites, winners.data() + i, queries.data() + i, kPacket, max_distance, closest);
    deliver(i, closest);
  }
  if (whole == queries.size()) return;
  Vec3 last[kPacket] = {};
  std::copy(queries.begin() + static_cast<std::ptrdiff_t>(whole), queries.end(), last);
  finish_packet(sites, winners.data() + whole, last, queries.size() - whole, max_distance, closest);
  deliver(whole, closest);
}

}  // namespace sdm::closest::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::closest {

HWY_EXPORT(Finish);

void finish(const sites::SitesData& sites, std::span<const std::uint32_t> winners,
            std::span<const Vec3> queries, double max_distance, const sites::ClosestSink& deliver) {
  HWY_DYNAMIC_DISPATCH(Finish)(sites, winners, queries, max_distance, deliver);
}

}  // namespace sdm::closest
#endif
