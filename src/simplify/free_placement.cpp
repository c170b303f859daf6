#include "simplify/free_placement.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "certify/hausdorff/nearest_face.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "geometry/triangle.h"
#include "simplify/certificate.h"
#include "simplify/high_parts.h"
#include "simplify/wedges.h"
#include "sites/sites_data.h"

namespace sdm::simplify {
namespace {

/// Corners of the face of the result that is nearest to a part.
struct Place {
  Triangle vertices{kNone, kNone, kNone};
  bool is_far = false;
};

// `parts`: of a surface; `to`: the other one.
void add_places(const Mesh& parts, const sites::SitesData& to, const sites::SitesData& result, double limit,
                std::vector<Place>& places) {
  const std::size_t first = places.size();
  places.resize(first + parts.triangles.size());
  parallel_for(parts.triangles.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Corners c = corners_of(parts, i);
      const std::array points{(1.0 / 3) * (c[0] + c[1] + c[2]), c[0], c[1], c[2]};
      Place& place = places[first + i];
      place.vertices = result.mesh.triangles[hausdorff::nearest_face(result, points[0], kNone).face];
      place.is_far = std::ranges::any_of(
          points, [&](const Vec3& p) { return hausdorff::nearest_face(to, p, kNone).lower > limit; });
    }
  });
}

// How often a mesh is mended, and how many collapses are undone at a vertex, one above the other: so many
// times more each time.
constexpr int kMostMendings = 2;
constexpr int kMoreLevels = 4;

// Rounds positions to float, and removes the faces whose corners then are at the same place.
void round_positions(Simplified& simplified) {
  Mesh& mesh = simplified.mesh;
  for (Vec3& p : mesh.positions) p = rounded_to_float(p);
  const auto same = [&](std::uint32_t a, std::uint32_t b) { return mesh.positions[a] == mesh.positions[b]; };
  std::size_t left = 0;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle t = mesh.triangles[f];
    if (same(t[0], t[1]) || same(t[1], t[2]) || same(t[2], t[0])) continue;
    mesh.triangles[left] = t;
    simplified.source_faces[left++] = simplified.source_faces[f];
  }
  mesh.triangles.resize(left);
  simplified.source_faces.resize(left);
}

// Vertices of the result near which a point of either surface is farther than the limit from the other one,
// the witness of the deviation among these; if no such point is known, those near parts that may have one.
std::vector<std::uint32_t> far_places(const Sites& input, const Mesh& result, double limit,
                                      const Progress& progress) {
  const Sites sites(result);
  std::vector<Place> places;
  add_places(parts_above(input.mesh(), internals(sites), limit, progress), internals(sites), internals(sites),
             limit, places);
  add_places(parts_above(result, internals(input), limit, progress), internals(input), internals(sites),
             limit, places);
  const bool any_far = std::ranges::any_of(places, &Place::is_far);
  std::vector<std::uint32_t> vertices;
  for (const Place& place : places)
    if (place.is_far || !any_far)
      vertices.insert(vertices.end(), place.vertices.begin(), place.vertices.end());
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  return vertices;
}

}  // namespace

FreePlacement::FreePlacement(const Mesh& start, const Sites& input, double size)
    : start_(start), input_(input), ladder_(size), sequence_(start, input, size) {}

Simplified FreePlacement::to_deviation(double limit, const SimplifyOptions& options, SimplifyReport& report) {
  Stopwatch watch;
  const int highest = ladder_.below(limit);
  sequence_.advance(highest);
  report.collapse_ms += watch.lap();
  Simplified best;
  std::size_t fewest = start_.triangles.size();
  for (int rung = highest; rung >= Ladder::kLowest && sequence_.faces_after(rung) < fewest; --rung) {
    Simplified found = first_within(limit, rung, fewest, options, report);
    if (found.mesh.triangles.empty()) continue;
    fewest = found.mesh.triangles.size();
    best = std::move(found);
  }
  return best;
}

// The meshes of a rung: what its collapses leave, then what is left if they are undone where it is farther
// from the input than the rung after it, and so on. None of them depends on the limit.
Simplified FreePlacement::first_within(double limit, int rung, std::size_t fewer_than,
                                       const SimplifyOptions& options, SimplifyReport& report) {
  const std::span<const CollapseOfEdge> collapses = sequence_.up_to(rung);
  const Expected expected{limit, ladder_.length(rung)};
  std::vector<bool> held;
  for (int mendings = 0, levels = 1;; ++mendings, levels *= kMoreLevels) {
    Stopwatch watch;
    CollapsedMesh collapsed = after_collapses(start_, collapses, held);
    Simplified result{.mesh = collapsed.mesh, .source_faces = collapsed.faces, .estimate = expected.estimate};
    if (options.single_precision) round_positions(result);
    report.collapse_ms += watch.lap();
    if (result.mesh.triangles.empty() || result.mesh.triangles.size() >= fewer_than) return {};
    if (!is_far_at_known(result.mesh, limit)) {
      result.deviation = deviation_of_input(input_, result.mesh, expected, options.progress);
      if (result.deviation.lower > limit) far_.push_back((*result.deviation.witness)[0]);
      if (result.deviation.upper <= limit)
        result.deviation =
            with_deviation_of_result(result.deviation, input_, result.mesh, expected, options.progress);
      ++report.candidates;
      report.deviation_ms += watch.lap();
      if (result.deviation.upper <= limit) return result;
    }
    if (mendings == kMostMendings) return {};
    const std::vector<std::uint32_t> far =
        far_places(input_, result.mesh, ladder_.length(rung + 1), options.progress);
    report.deviation_ms += watch.lap();
    held.resize(collapses.size());
    hold_back(collapsed, far, levels, collapses, held);
  }
}

bool FreePlacement::is_far_at_known(const Mesh& result, double limit) const {
  if (far_.empty()) return false;
  const Sites sites(result);
  return std::ranges::any_of(
      far_, [&](const Vec3& p) { return hausdorff::nearest_face(internals(sites), p, kNone).lower > limit; });
}

// Undoes the last collapses of these vertices: `levels` of the tree of collapses that made each of them.
void FreePlacement::hold_back(const CollapsedMesh& mesh, const std::vector<std::uint32_t>& vertices,
                              int levels, std::span<const CollapseOfEdge> collapses,
                              std::vector<bool>& held) const {
  std::vector<std::uint32_t> level, below;
  for (const std::uint32_t v : vertices) level.push_back(mesh.last[v]);
  for (int i = 0; i < levels && !level.empty(); ++i) {
    below.clear();
    for (const std::uint32_t c : level) {
      if (c == kNone) continue;
      held[c] = true;
      below.push_back(collapses[c].before_u);
      below.push_back(collapses[c].before_v);
    }
    std::swap(level, below);
  }
}

}  // namespace sdm::simplify
