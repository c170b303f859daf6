#include <sdm/error.h>
#include <sdm/measure.h>
#include <sdm/mesh.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <new>
#include <numeric>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/arrays/rows.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/point_triangle.h"
#include "geometry/triangle_pair.h"
#include "geometry/vec.h"

namespace sdm::self {
namespace {

/// The faces of a mesh grouped into small pieces of its surface. Every face belongs to one patch. Patches are
/// numbered by their first faces.
struct Patches {
  CompressedRows<std::uint32_t> faces;  ///< of each patch, in increasing order
  std::vector<std::uint32_t> of;        ///< the patch of each face

  [[nodiscard]] std::size_t count() const { return faces.size(); }
};

// How far a patch may reach beyond the ball of its centroids: it bounds the spheres around patches.
constexpr double kCornerReach = 1.5;

std::vector<Vec3> centroids(const Mesh& mesh) {
  std::vector<Vec3> result(mesh.triangles.size());
  parallel_for(result.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto& [a, b, c] = mesh.triangles[f];
      // Thirds first: coordinates may be close to the largest of the type.
      constexpr double kThird = 1.0 / 3;
      result[f] = kThird * mesh.positions[a] + kThird * mesh.positions[b] + kThird * mesh.positions[c];
    }
  });
  return result;
}

Patches with_faces(std::vector<std::uint32_t> patch_of, std::size_t count) {
  Patches patches{make_rows<std::uint32_t>(count,
                                           [&](const auto& put) {
                                             for (std::uint32_t f = 0; f < patch_of.size(); ++f)
                                               put(patch_of[f], f);
                                           }),
                  {}};
  patches.of = std::move(patch_of);
  return patches;
}

/// The faces of each vertex.
CompressedRows<std::uint32_t> faces_of_vertices(const Mesh& mesh) {
  return make_rows<std::uint32_t>(mesh.positions.size(), [&](const auto& put) {
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
      for (const std::uint32_t v : mesh.triangles[f]) put(v, f);
  });
}

/// One patch for each face.
Patches single_faces(std::size_t faces) {
  std::vector<std::uint32_t> patch_of(faces);
  std::iota(patch_of.begin(), patch_of.end(), 0u);
  return with_faces(std::move(patch_of), faces);
}

/// Groups faces around seeds that are about `radius` apart. A face belongs to the nearest seed, by centroids,
/// among those from which a chain of faces, each sharing a vertex with the next, leads to it without leaving
/// the seed's ball: centroids stay within `radius` of the seed's, corners within 1.5 of it. Faces too large
/// for that are patches of their own. Cost: linear on a surface of bounded valence, as the balls around seeds
/// then overlap a bounded number of times.
Patches group_faces(const Mesh& mesh, const CompressedRows<std::uint32_t>& faces_of_vertex, double radius) {
  const std::size_t count = mesh.triangles.size();
  const std::vector<Vec3> centroid = centroids(mesh);
  std::vector<std::uint32_t> patch_of(count, kNone), seen_by(count, kNone),
      met_by(mesh.positions.size(), kNone);
  std::vector<double> nearest(count, kInfinity);  // squared
  std::vector<std::uint32_t> flood;
  std::uint32_t patches = 0;
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    if (patch_of[seed] != kNone) continue;
    const std::uint32_t patch = patches++;
    patch_of[seed] = patch;
    nearest[seed] = 0;
    const auto within = [&](double radius_of_ball, const Vec3& p) {
      return squared_norm(p - centroid[seed]) <= radius_of_ball * radius_of_ball;
    };
    const auto fits = [&](std::uint32_t face) {
      return within(radius, centroid[face]) &&
             std::ranges::all_of(mesh.triangles[face], [&](std::uint32_t v) {
               return within(kCornerReach * radius, mesh.positions[v]);
             });
    };
    if (!fits(seed)) continue;
    const auto enter = [&](std::uint32_t face) {
      if (seen_by[face] == patch) return;
      seen_by[face] = patch;
      if (!fits(face)) return;
      const double squared = squared_norm(centroid[face] - centroid[seed]);
      flood.push_back(face);
      if (squared < nearest[face]) {
        nearest[face] = squared;
        patch_of[face] = patch;
      }
    };
    flood.clear();
    enter(seed);
    for (std::size_t i = 0; i < flood.size(); ++i)
      for (const std::uint32_t v : mesh.triangles[flood[i]]) {
        if (met_by[v] == patch) continue;
        met_by[v] = patch;
        for (const std::uint32_t face : faces_of_vertex.of(v)) enter(face);
      }
  }
  return with_faces(std::move(patch_of), patches);
}

}  // namespace
}  // namespace sdm::self

namespace sdm {
namespace {

// Seeds of patches are this fraction of the geodesic length apart. The number of patches that one excludes is
// proportional to the inverse square, what is excluded beyond the length proportional to the fraction.
constexpr double kPatchRadius = 1.0 / 6;

constexpr const char* kNeighbourhoods = "the excluded neighbourhoods";

struct Sphere {
  Vec3 centre;
  double radius = 0;
};

// The patches reachable from each patch through shared vertices.
class Neighbours {
 public:
  Neighbours(const Mesh& mesh, const ExclusionRule& rule, const self::Patches& patches,
             const CompressedRows<std::uint32_t>& faces_of_vertex)
      : mesh_(mesh), rule_(rule), patches_(patches) {
    join(faces_of_vertex);
    if (rule.geodesic) enclose();
  }

  // The patch and those that it reaches, in increasing order.
  [[nodiscard]] std::vector<std::uint32_t> of(std::uint32_t patch) const {
    std::vector<std::uint32_t> reached{patch};
    reach(patch, reached);
    std::ranges::sort(reached);
    return reached;
  }

 private:
  struct Met {
    std::vector<bool> joints, patches;
  };
  // Resets what was set for these patches.
  struct Forget {
    const Neighbours& neighbours;
    Met& met;
    const std::vector<std::uint32_t>&reached, &rejected;

    ~Forget() {
      for (const std::uint32_t p : rejected) met.patches[p] = false;
      for (const std::uint32_t p : reached) {
        met.patches[p] = false;
        for (const std::uint32_t joint : neighbours.joints_of_.of(p)) met.joints[joint] = false;
      }
    }
  };

  // Adds the patches that `patch` reaches, other than itself.
  void reach(std::uint32_t patch, std::vector<std::uint32_t>& reached) const {
    thread_local Met met;  // none is set between calls
    if (met.joints.size() < patches_at_.size()) met.joints.resize(patches_at_.size());
    if (met.patches.size() < patches_.count()) met.patches.resize(patches_.count());
    std::vector<std::uint32_t> rejected;
    const Forget forget{*this, met, reached, rejected};  // also if memory runs out
    met.patches[patch] = true;
    std::size_t begin = 0;
    for (std::uint32_t ring = 1; begin < reached.size() && (rule_.geodesic || ring <= rule_.rings); ++ring)
      for (const std::size_t end = reached.size(); begin < end; ++begin)
        for (const std::uint32_t joint : joints_of_.of(reached[begin])) {
          if (met.joints[joint]) continue;
          met.joints[joint] = true;
          for (const std::uint32_t other : patches_at_.of(joint)) {
            if (met.patches[other]) continue;
            const bool admitted = ring == 1 || !rule_.geodesic || within(*rule_.geodesic, patch, other);
            (admitted ? reached : rejected).push_back(other);
            met.patches[other] = true;
          }
        }
  }

  // Finds the joints: vertices at which patches meet, with these patches.
  void join(const CompressedRows<std::uint32_t>& faces_of_vertex) {
    std::vector<std::uint32_t> around;
    patches_at_.offsets.assign(1, 0);
    for (std::size_t v = 0; v < faces_of_vertex.size(); ++v) {
      around.clear();
      for (const std::uint32_t f : faces_of_vertex.of(v)) around.push_back(patches_.of[f]);
      std::ranges::sort(around);
      around.erase(std::unique(around.begin(), around.end()), around.end());
      if (around.size() < 2) continue;
      patches_at_.items.append(around.begin(), around.end());
      patches_at_.offsets.push_back(static_cast<std::uint32_t>(patches_at_.items.size()));
    }
    joints_of_ = make_rows<std::uint32_t>(patches_.count(), [&](const auto& put) {
      for (std::uint32_t joint = 0; joint < patches_at_.size(); ++joint)
        for (const std::uint32_t p : patches_at_.of(joint)) put(p, joint);
    });
  }

  void enclose() {
    spheres_.resize(patches_.count());
    parallel_for(spheres_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) {
        Box box;
        const auto for_each_corner = [&](const auto& visit) {
          for (const std::uint32_t f : patches_.faces.of(p))
            for (const std::uint32_t v : mesh_.triangles[f]) visit(mesh_.positions[v]);
        };
        for_each_corner([&](const Vec3& corner) { extend(box, corner); });
        double squared = 0;
        for_each_corner(
            [&](const Vec3& corner) { squared = std::max(squared, squared_norm(corner - centre(box))); });
        spheres_[p] = {centre(box), std::sqrt(squared)};
      }
    });
  }

  [[nodiscard]] bool within(double length, std::uint32_t p, std::uint32_t q) const {
    const Sphere &a = spheres_[p], &b = spheres_[q];
    const double max_distance = length + a.radius + b.radius;
    // Rounding must not exclude less.
    if (squared_norm(b.centre - a.centre) > (1 + 1e-12) * max_distance * max_distance) return false;
    const auto faces_p = patches_.faces.of(p), faces_q = patches_.faces.of(q);
    // A single face may be long: its sphere says little.
    if (faces_p.size() > 1 && faces_q.size() > 1) return true;
    if (faces_p.size() > 1) return face_within(length + a.radius, faces_q[0], a.centre);
    if (faces_q.size() > 1) return face_within(length + b.radius, faces_p[0], b.centre);
    return faces_within(length, faces_p[0], faces_q[0]);
  }
  [[nodiscard]] bool face_within(double length, std::uint32_t f, const Vec3& point) const {
    const double most = (1 + 1e-12) * length * length;
    return squared_norm(closest_on_triangle(point, corners_of(mesh_, f)) - point) <= most;
  }
  [[nodiscard]] bool faces_within(double length, std::uint32_t f, std::uint32_t g) const {
    const Corners a = corners_of(mesh_, f), b = corners_of(mesh_, g);
    const double most = length * length;
    // Corners or boxes decide in nearly all cases.
    for (const Vec3& p : a)
      for (const Vec3& q : b)
        if (squared_norm(q - p) < most) return true;
    return squared_box_distance(a, b) < most && closest_or_common(a, b).squared < most;
  }

  const Mesh& mesh_;
  const ExclusionRule& rule_;
  const self::Patches& patches_;
  CompressedRows<std::uint32_t> patches_at_, joints_of_;
  std::vector<Sphere> spheres_;  // around patches
};

// Numbers of equal rows, if these are long: around a vertex of many faces, all faces may have the same one.
class LongRows {
 public:
  static bool is_long(std::span<const std::uint32_t> row) {
    constexpr std::size_t kLong = 256;
    return row.size() >= kLong;
  }
  /// The number of a row that equals it; `number`, which it then has, if it is the first one.
  template <class RowOf>
  std::uint32_t find(std::span<const std::uint32_t> row, std::uint32_t number, const RowOf& row_of) {
    const auto [begin, end] = numbers_.equal_range(hash(row));
    for (auto known = begin; known != end; ++known)
      if (std::ranges::equal(row, row_of(known->second))) return known->second;
    numbers_.emplace(hash(row), number);
    return number;
  }

 private:
  static std::uint64_t hash(std::span<const std::uint32_t> row) {
    std::uint64_t h = row.size();
    for (const std::uint32_t x : row) h = (h ^ x) * 0x9E3779B97F4A7C15u;
    return h;
  }

  std::unordered_multimap<std::uint64_t, std::uint32_t> numbers_;
};

// All faces at a vertex exclude each other.
void check_pairs(const CompressedRows<std::uint32_t>& faces_of_vertex, std::size_t faces) {
  constexpr std::uint64_t kLeast = 100'000'000, kOfEachFace = 100;
  const std::uint64_t most = std::max<std::uint64_t>(kLeast, kOfEachFace * faces);
  std::uint64_t pairs = 0;
  for (std::size_t v = 0; v < faces_of_vertex.size(); ++v)
    pairs += std::uint64_t{faces_of_vertex.of(v).size()} * faces_of_vertex.of(v).size();
  if (pairs > most)
    throw Error("the distances of the mesh to itself are not determined: more than " + std::to_string(most) +
                " pairs of faces share a vertex; divide the vertices of most faces");
}

}  // namespace

Exclusion::Exclusion(const Mesh& rest, const ExclusionOptions& options) try {
  const ExclusionRule& rule = options.rule;
  validate(rest);
  check_options(rule);
  const CompressedRows<std::uint32_t> faces_of_vertex = self::faces_of_vertices(rest);
  if (!rule.geodesic) check_pairs(faces_of_vertex, rest.triangles.size());
  self::Patches grouped = rule.geodesic
                              ? self::group_faces(rest, faces_of_vertex, kPatchRadius * *rule.geodesic)
                              : self::single_faces(rest.triangles.size());
  const Neighbours neighbours(rest, rule, grouped, faces_of_vertex);
  const std::size_t count = grouped.count();
  offsets_.assign(1, 0);

  // Patches are processed in portions whose neighbourhoods take about this many entries, judging by those
  // before: the total is checked before it is stored, and that of a portion while it grows.
  constexpr std::size_t kEntries = std::size_t{1} << 24, kLeast = 256, kMost = std::size_t{1} << 16,
                        kGrain = 64;
  std::vector<std::vector<std::uint32_t>> rows;
  LongRows long_rows;
  for (std::size_t first = 0, block = kLeast; first < count;) {
    const std::size_t end = std::min(count, first + block);
    rows.resize(end - first);
    std::atomic<std::size_t> entries{0};
    parallel_for(rows.size(), kGrain, [&](std::size_t begin, std::size_t last) {
      for (std::size_t i = begin; i < last; ++i) {
        rows[i] = neighbours.of(static_cast<std::uint32_t>(first + i));
        const std::size_t before = entries.fetch_add(rows[i].size());
        if (before / kEntries != (before + rows[i].size()) / kEntries)
          require_memory(kEntries * sizeof(std::uint32_t), kNeighbourhoods);
      }
    });
    for (const std::vector<std::uint32_t>& row : rows) {
      const auto number = static_cast<std::uint32_t>(offsets_.size() - 1);
      const auto known = [&](std::uint32_t n) {
        return std::span(excluded_).subspan(offsets_[n], offsets_[n + 1] - offsets_[n]);
      };
      if (!rule.geodesic) {
        rows_.push_back(LongRows::is_long(row) ? long_rows.find(row, number, known) : number);
        if (rows_.back() != number) continue;
      }
      if (excluded_.size() + row.size() > excluded_.capacity()) {
        const std::size_t room = std::max(excluded_.size() + row.size(), 2 * excluded_.capacity());
        require_memory(room * sizeof(std::uint32_t), kNeighbourhoods);
        excluded_.reserve(room);
      }
      excluded_.insert(excluded_.end(), row.begin(), row.end());
      offsets_.push_back(excluded_.size());
    }
    if (options.progress &&
        !options.progress("neighbourhoods", static_cast<double>(end) / static_cast<double>(count)))
      throw Cancelled();
    block = std::clamp(kEntries / std::max<std::size_t>(1, entries / rows.size()), kLeast, kMost);
    first = end;
  }
  if (rule.geodesic) keep_mutual();
  if (offsets_.size() == count + 1) rows_ = {};
  patch_of_ = std::move(grouped.of);
  patch_faces_ = std::move(grouped.faces.items).to_vector();
  face_offsets_ = std::move(grouped.faces.offsets).to_vector();
} catch (const std::bad_alloc&) {
  throw out_of_memory(kNeighbourhoods);
}

bool Exclusion::excludes(std::uint32_t face1, std::uint32_t face2) const {
  return std::ranges::binary_search(excluded_by(patch_of(face1)), patch_of(face2));
}

// Keeps only mutual exclusions: the search from one patch may miss another whose search finds it.
void Exclusion::keep_mutual() {
  std::vector<std::uint8_t> mutual(excluded_.size());
  const std::size_t count = offsets_.size() - 1;
  constexpr std::size_t kGrain = 1024;
  parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      for (std::size_t i = offsets_[p]; i < offsets_[p + 1]; ++i)
        mutual[i] = std::ranges::binary_search(excluded_by(excluded_[i]), static_cast<std::uint32_t>(p));
  });
  std::size_t kept = 0;
  for (std::size_t p = 0, i = 0; p < count; ++p) {
    for (; i < offsets_[p + 1]; ++i)
      if (mutual[i]) excluded_[kept++] = excluded_[i];
    offsets_[p + 1] = kept;
  }
  excluded_.resize(kept);
}

}  // namespace sdm
