#include "engine/cpu/finish.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/finish.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <bit>

#include "core/vec.h"
#include "engine/closest_on_face.h"
#include "engine/engine.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kPacket = PointGroup::kPacket;
using Doubles = hn::CappedTag<double, 8>;
using Vec = hn::Vec<Doubles>;

struct Vec3v {
  Vec x, y, z;
};
HWY_INLINE Vec dot(const Vec3v& a, const Vec3& b) {
  const Doubles d;
  return hn::MulAdd(a.z, hn::Set(d, b[2]), hn::MulAdd(a.y, hn::Set(d, b[1]), hn::Mul(a.x, hn::Set(d, b[0]))));
}
HWY_INLINE Vec3v minus(const Vec3v& a, const Vec3& b) {
  const Doubles d;
  return {hn::Sub(a.x, hn::Set(d, b[0])), hn::Sub(a.y, hn::Set(d, b[1])), hn::Sub(a.z, hn::Set(d, b[2]))};
}
// a − t b
HWY_INLINE Vec3v minus(const Vec3v& a, Vec t, const Vec3& b) {
  const Doubles d;
  return {hn::NegMulAdd(t, hn::Set(d, b[0]), a.x), hn::NegMulAdd(t, hn::Set(d, b[1]), a.y),
          hn::NegMulAdd(t, hn::Set(d, b[2]), a.z)};
}

// A packet of queries, and the points found for them.
struct Packet {
  alignas(64) double query[3][kPacket], point[3][kPacket], distance[kPacket];
};

// Runs on(query, from) for those vectors of a packet that have one of `lanes`: it sets from = query − closest
// point and returns the mask of queries that lie in the site's region. Their lanes are returned.
template <class On>
HWY_INLINE uint32_t for_lanes(Packet& p, uint32_t lanes, const On& on) {
  const Doubles d;
  const uint32_t all = (1u << hn::Lanes(d)) - 1;
  uint32_t inside = 0;
  for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    if ((lanes >> i & all) == 0) continue;
    const Vec3v query{hn::Load(d, p.query[0] + i), hn::Load(d, p.query[1] + i), hn::Load(d, p.query[2] + i)};
    Vec3v from;
    const auto mask = on(query, from);
    const Vec3v point{hn::Sub(query.x, from.x), hn::Sub(query.y, from.y), hn::Sub(query.z, from.z)};
    hn::Store(point.x, d, p.point[0] + i);
    hn::Store(point.y, d, p.point[1] + i);
    hn::Store(point.z, d, p.point[2] + i);
    // Of the point as rounded, so that it agrees with it to the last.
    const Vec x = hn::Sub(query.x, point.x), y = hn::Sub(query.y, point.y), z = hn::Sub(query.z, point.z);
    hn::Store(hn::Sqrt(hn::MulAdd(z, z, hn::MulAdd(y, y, hn::Mul(x, x)))), d, p.distance + i);
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    inside |= static_cast<uint32_t>(bytes[0]) << i;
  }
  return inside & lanes;
}

// Over the face, on the inner side of its three walls.
uint32_t on_face(const Sites::Impl& sites, uint32_t face, Packet& p, uint32_t lanes) {
  if (sites.sliver[face]) return 0;
  const Triangle& t = sites.mesh.triangles[face];
  const Vec3 &a = sites.mesh.positions[t[0]], &b = sites.mesh.positions[t[1]],
             &c = sites.mesh.positions[t[2]];
  const Vec3 normal = cross(b - a, c - b);
  const Vec3 wall[3] = {cross(normal, b - a), cross(normal, c - b), cross(normal, a - c)};
  const double offset = sdm::dot(b - a, wall[1]), inverse = 1 / squared_norm(normal);
  return for_lanes(p, lanes, [&](const Vec3v& query, Vec3v& from) HWY_ATTR {
    const Doubles d;
    const Vec3v r = minus(query, a);
    const Vec least =
        hn::Min(hn::Min(dot(r, wall[0]), dot(r, wall[2])), hn::Sub(dot(r, wall[1]), hn::Set(d, offset)));
    const Vec h = hn::Mul(dot(r, normal), hn::Set(d, inverse));
    from = {hn::Mul(h, hn::Set(d, normal[0])), hn::Mul(h, hn::Set(d, normal[1])),
            hn::Mul(h, hn::Set(d, normal[2]))};
    return hn::Gt(least, hn::Zero(d));
  });
}

// Between the ends of the edge, where none of its faces comes closer.
uint32_t on_edge(const Sites::Impl& sites, uint32_t edge, Packet& p, uint32_t lanes) {
  const auto [a, b] = sites.topology.edges[edge];
  const Vec3 &start = sites.mesh.positions[a], along = sites.mesh.positions[b] - start;
  const double inverse = 1 / squared_norm(along);
  const auto faces = sites.topology.edge_faces(edge);
  return for_lanes(p, lanes, [&](const Vec3v& query, Vec3v& from) HWY_ATTR {
    const Doubles d;
    const Vec3v r = minus(query, start);
    const Vec t = hn::Mul(dot(r, along), hn::Set(d, inverse));
    from = minus(r, t, along);
    auto inside = hn::And(hn::Gt(t, hn::Zero(d)), hn::Lt(t, hn::Set(d, 1.0)));
    for (const std::uint32_t face : faces) {
      const Triangle& corners = sites.mesh.triangles[face];
      const Vec3 opposite = sites.mesh.positions[corners[0] ^ corners[1] ^ corners[2] ^ a ^ b] - start;
      const Vec3 inward = opposite - sdm::dot(opposite, along) * inverse * along;
      inside = hn::And(inside, hn::Le(dot(from, inward), hn::Zero(d)));
    }
    return inside;
  });
}

// Where no edge of the vertex comes closer.
uint32_t on_vertex(const Sites::Impl& sites, uint32_t vertex, Packet& p, uint32_t lanes) {
  const Vec3& point = sites.mesh.positions[vertex];
  return for_lanes(p, lanes, [&](const Vec3v& query, Vec3v& from) HWY_ATTR {
    const Doubles d;
    from = minus(query, point);
    Vec most = hn::Zero(d);
    for (const std::uint32_t face : sites.vertex_faces.of(vertex))
      for (const std::uint32_t corner : sites.mesh.triangles[face])
        most = hn::Max(most, dot(from, sites.mesh.positions[corner] - point));
    return hn::Le(most, hn::Zero(d));
  });
}

uint32_t on_site(const Sites::Impl& sites, SiteId site, Packet& p, uint32_t lanes) {
  switch (site.type()) {
    case SiteType::face:
      return on_face(sites, site.site(), p, lanes);
    case SiteType::edge:
      return on_edge(sites, site.site(), p, lanes);
    default:
      return on_vertex(sites, site.site(), p, lanes);
  }
}

uint32_t face_of(const Sites::Impl& sites, SiteId site) {
  switch (site.type()) {
    case SiteType::face:
      return site.site();
    case SiteType::edge:
      return sites.topology.edge_faces(site.site())[0];
    default:
      return sites.vertex_faces.of(site.site())[0];
  }
}

void finish_packet(const Sites::Impl& sites, const uint32_t* winners, std::span<const Vec3> queries,
                   double max_distance, ClosestPoint* out) {
  Packet p;
  for (size_t i = 0; i < kPacket; ++i)
    for (int k = 0; k < 3; ++k) p.query[k][i] = queries[std::min(i, queries.size() - 1)][k];
  for (uint32_t pending = (1u << queries.size()) - 1; pending != 0;) {
    const SiteId site{winners[std::countr_zero(pending)]};
    uint32_t lanes = 0;
    for (size_t i = 0; i < queries.size(); ++i)
      lanes |= static_cast<uint32_t>(winners[i] == site.packed) << i;
    pending &= ~lanes;
    if (site.type() == SiteType::none) {
      for (; lanes != 0; lanes &= lanes - 1) {
        const auto i = static_cast<size_t>(std::countr_zero(lanes));
        out[i] = {};
        if (site.packed == SiteId::kUnsettled)
          reference_search(sites, queries.subspan(i, 1), max_distance, {out + i, 1});
      }
      continue;
    }
    const uint32_t face = face_of(sites, site), inside = on_site(sites, site, p, lanes);
    for (; lanes != 0; lanes &= lanes - 1) {
      const int i = std::countr_zero(lanes);
      ClosestPoint& c = out[i];
      if (inside >> i & 1) {
        for (int k = 0; k < 3; ++k) c.point[k] = p.point[k][i];
        c.distance = p.distance[i];
        c.site = site.site();
        c.type = site.type();
        c.face = face;
      } else {
        c = closest_around_face(sites, face, queries[i]);
      }
      if (c.distance > max_distance) c = {};
    }
  }
}

void Finish(const Sites::Impl& sites, std::span<const uint32_t> winners, std::span<const Vec3> queries,
            double max_distance, std::span<ClosestPoint> out) {
  for (size_t i = 0; i < queries.size(); i += kPacket)
    finish_packet(sites, winners.data() + i, queries.subspan(i, std::min(kPacket, queries.size() - i)),
                  max_distance, out.data() + i);
}

}  // namespace sdm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm {

HWY_EXPORT(Finish);

void finish(const Sites::Impl& sites, std::span<const std::uint32_t> winners, std::span<const Vec3> queries,
            double max_distance, std::span<ClosestPoint> out) {
  HWY_DYNAMIC_DISPATCH(Finish)(sites, winners, queries, max_distance, out);
}

}  // namespace sdm
#endif
