#include "certify/hausdorff/first_parts.h"

#include <algorithm>
#include <array>
#include <optional>

#include "certify/hausdorff/nearest_face.h"
#include "core/parallel.h"

namespace sdm::hausdorff {
namespace {

struct Site {
  SiteType type;
  std::uint32_t site;
};

std::span<const std::uint32_t> faces_of(const sites::SitesData& b, const Site& s) {
  switch (s.type) {
    case SiteType::vertex:
      return b.vertex_faces.of(s.site);
    case SiteType::edge:
      return b.topology.edge_faces(s.site);
    default:
      return {&s.site, 1};
  }
}

bool has(const sites::SitesData& b, std::uint32_t face, const Site& s) {
  switch (s.type) {
    case SiteType::vertex:
      return std::ranges::count(b.mesh.triangles[face], s.site) > 0;
    case SiteType::edge:
      return std::ranges::count(b.topology.face_edges[face], s.site) > 0;
    default:
      return face == s.site;
  }
}

// A face that has all three sites, or kNone.
std::uint32_t common_face(const sites::SitesData& b, const std::array<Site, 3>& sites) {
  for (const std::uint32_t face : faces_of(b, sites[0]))
    if (has(b, face, sites[1]) && has(b, face, sites[2])) return face;
  return kNone;
}

// The corner of a face that is closest to p.
Site nearest_corner(const sites::SitesData& b, std::uint32_t face, const Vec3& p) {
  const Triangle& t = b.mesh.triangles[face];
  return {SiteType::vertex, *std::ranges::min_element(t, {}, [&](std::uint32_t v) {
            return squared_norm(b.mesh.positions[v] - p);
          })};
}

// Adds faces of B until the bound is at most `enough`.
void bound_face(const sites::SitesData& b, const std::array<VertexDistance, 3>& corner, double enough,
                FacePart& part) {
  const auto offer = [&](std::uint32_t face) {
    if (face == kNone || !part.add(b, face, 0)) return false;
    const Vec3& d = part.distances[part.count - 1];
    part.upper = std::min(part.upper, std::max({d[0], d[1], d[2]}));
    return part.upper <= enough;
  };
  // A face on which all three closest points lie attains the least bound.
  std::array<Site, 3> site;
  for (int i = 0; i < 3; ++i) site[i] = {corner[i].type, corner[i].site};
  if (offer(common_face(b, site))) return;
  if (part.count == 0) {
    // Where B is a variant of A, the counterpart of a face has the vertices of B near its corners.
    for (int i = 0; i < 3; ++i) site[i] = nearest_corner(b, corner[i].face, part.at[i]);
    if (offer(common_face(b, site))) return;
  }
  for (const VertexDistance& c : corner)
    if (offer(c.face)) return;
  part.bound();
}

}  // namespace

FirstParts first_parts(const Mesh& a, const sites::SitesData& b, std::span<const VertexDistance> vertices,
                       double lower, double precision) {
  constexpr std::size_t kBlock = 1 << 12;
  const std::size_t blocks = (a.triangles.size() + kBlock - 1) / kBlock;
  std::vector<FirstParts> found(blocks);
  parallel_for(blocks, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = kBlock * begin; f < std::min(kBlock * end, a.triangles.size()); ++f) {
      const Triangle& t = a.triangles[f];
      if (repeats_corner(t)) continue;
      std::array<VertexDistance, 3> corner;
      for (int i = 0; i < 3; ++i) corner[i] = vertices[t[i]];
      if (std::ranges::any_of(corner, [](const VertexDistance& d) { return d.face == kNone; })) continue;
      FirstParts& block = found[f / kBlock];
      // The distance to one face is convex.
      if (corner[0].face == corner[1].face && corner[1].face == corner[2].face) {
        const double upper = std::max({corner[0].upper, corner[1].upper, corner[2].upper});
        if (upper <= lower) {
          block.settled = std::max(block.settled, upper);
          continue;
        }
      }
      FacePart part{.at = corners_of(a, static_cast<std::uint32_t>(f)),
                    .face = static_cast<std::uint32_t>(f)};
      bound_face(b, corner, lower, part);
      if (part.upper <= lower + precision)
        block.settled = std::max(block.settled, part.upper);
      else
        block.parts.push_back(part);
    }
  });
  FirstParts all;
  for (FirstParts& block : found) {
    all.parts.insert(all.parts.end(), block.parts.begin(), block.parts.end());
    all.settled = std::max(all.settled, block.settled);
  }
  return all;
}

namespace {

// Bounds faces of A that are near each other, one after the other.
class MatchedFaces {
 public:
  MatchedFaces(const Mesh& a, const sites::SitesData& b, const Matching& matching, double precision,
               bool reuses, const LowerBound& lower)
      : a_(a), b_(b), matching_(matching), precision_(precision), reuses_(reuses), lower_(lower) {}

  void bound(std::uint32_t face) {
    if (repeats_corner(a_.triangles[face]) || !matching_.has_normal(face)) return;
    FacePart part{.at = corners_of(a_, face), .face = face};
    consider(last_, part);
    std::array<bool, 3> searched{};
    for (int i = 0; i < 3 && reuses_ && (part.count == 0 || part.upper > enough()); ++i)
      searched[i] = consider(known_at(a_.triangles[face][i]), part);
    while (part.count == 0 || part.upper > enough()) {
      const std::optional<int> corner = highest_corner(part, searched);
      if (!corner) break;
      searched[*corner] = true;
      const NearestFace nearest =
          nearest_face(b_, part.at[*corner], part.count == 0 ? kNone : part.b_faces[part.closest(*corner)],
                       matching_, face);
      if (nearest.face == kNone) return found.unmatched.push_back(face);
      lower_.raise(part.at[*corner], 0, face, nearest);
      last_ = nearest.face;
      if (const std::uint32_t vertex = a_.triangles[face][*corner]; reuses_)
        known_[vertex % known_.size()] = {vertex, nearest.face};
      if (part.add(b_, nearest.face, 0)) part.bound();
    }
    if (part.upper <= enough())
      found.settled = std::max(found.settled, part.upper);
    else
      found.parts.push_back(part);
  }

  [[nodiscard]] const LowerBound& lower() const { return lower_; }

  MatchedParts found;

 private:
  // A face of B that was found at a vertex for a face around it. Other faces around the vertex are near it
  // too, if it is allowed for them.
  struct Known {
    std::uint32_t vertex = kNone, face = kNone;
  };

  [[nodiscard]] std::uint32_t known_at(std::uint32_t vertex) const {
    const Known& known = known_[vertex % known_.size()];
    return known.vertex == vertex ? known.face : kNone;
  }
  // Returns whether the face is allowed.
  bool consider(std::uint32_t near, FacePart& part) const {
    if (near == kNone || !matching_.allows(part.face, near)) return false;
    if (part.add(b_, near, 0)) part.bound();
    return true;
  }
  [[nodiscard]] double enough() const { return lower_.value + precision_; }

  // Returns the corner that is farthest from its closest face, of those that were not searched from.
  static std::optional<int> highest_corner(const FacePart& part, const std::array<bool, 3>& searched) {
    std::optional<int> highest;
    double most = -1;
    for (int i = 0; i < 3; ++i) {
      if (searched[i]) continue;
      const double distance = part.count == 0 ? 0 : part.distances[part.closest(i)][i];
      if (distance > most) {
        most = distance;
        highest = i;
      }
    }
    return highest;
  }

  const Mesh& a_;
  const sites::SitesData& b_;
  const Matching& matching_;
  double precision_;
  bool reuses_;
  LowerBound lower_;
  std::uint32_t last_ = kNone;  // the face of B that was found last
  std::array<Known, 1024> known_{};
};

}  // namespace

MatchedParts matched_parts(const Mesh& a, const sites::SitesData& b, const Matching& matching,
                           double precision, bool decides, const Progress& progress, LowerBound& lower) {
  constexpr std::size_t kBlock = 1 << 12;
  const std::size_t count = a.triangles.size();
  // The faces of a sample raise the lower bound first, so that few of all are searched from.
  constexpr std::size_t kSample = 64;
  MatchedParts all;
  for (const std::size_t stride : {kSample, std::size_t{1}}) {
    const std::size_t step = kBlock * stride, blocks = (count + step - 1) / step;
    std::vector<MatchedFaces> work(blocks, MatchedFaces(a, b, matching, precision, decides, lower));
    const auto bound = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t f = step * i; f < std::min(step * (i + 1), count); f += stride)
          work[i].bound(static_cast<std::uint32_t>(f));
    };
    parallel_for(blocks, 1, stride > 1 ? Progress() : progress, "vertices", bound);
    for (const MatchedFaces& block : work) lower.raise(block.lower());
    if (stride > 1) continue;
    for (const MatchedFaces& block : work) {
      const MatchedParts& found = block.found;
      all.parts.insert(all.parts.end(), found.parts.begin(), found.parts.end());
      all.settled = std::max(all.settled, found.settled);
      all.unmatched.insert(all.unmatched.end(), found.unmatched.begin(), found.unmatched.end());
    }
  }
  return all;
}

}  // namespace sdm::hausdorff
