#include "atlas/charts/split.h"

#include <algorithm>
#include <queue>

#include "atlas/charts/overlap.h"
#include "core/parallel.h"

namespace sdm::atlas {
namespace {

class Splitter {
 public:
  Splitter(const Mesh& mesh, const FaceGeometry& faces) : mesh_(mesh), faces_(faces) {}

  // Appends the pieces of the chart.
  void split(Chart chart, std::vector<Chart>& result) const {
    std::vector<Chart> pending;
    pending.push_back(std::move(chart));
    while (!pending.empty()) {
      Chart piece = std::move(pending.back());
      pending.pop_back();
      const std::vector<GridTriangle> triangles = remove_flipped(piece, result);
      if (piece.faces.empty()) continue;
      const auto overlap = find_overlap(triangles, 0, pair_budget(triangles.size()));
      if (!overlap) {
        result.push_back(std::move(piece));
        continue;
      }
      for (Chart& half : cut(piece, piece.faces[overlap->first], piece.faces[overlap->second]))
        pending.push_back(std::move(half));
    }
  }

 private:
  std::vector<GridTriangle> remove_flipped(Chart& chart, std::vector<Chart>& result) const {
    std::vector<GridTriangle> triangles = snap(mesh_, chart);
    if (chart.faces.size() == 1) return triangles;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::uint32_t f = chart.faces[i];
      if (orientation(triangles[i][0], triangles[i][1], triangles[i][2]) < 0) {
        result.push_back({faces_.normal[f], {f}});
      } else {
        chart.faces[kept] = f;
        triangles[kept++] = triangles[i];
      }
    }
    chart.faces.resize(kept);
    triangles.resize(kept);
    return triangles;
  }

  // Cuts the chart into two parts grown from one face each; each face joins the part that is nearer along the
  // chart. Faces that neither reaches (an earlier cut has disconnected them) form a third part.
  [[nodiscard]] std::vector<Chart> cut(const Chart& chart, std::uint32_t first, std::uint32_t second) const {
    struct Front {
      double cost;
      std::uint32_t face;
      std::uint8_t half;
      auto operator<=>(const Front&) const = default;
    };
    const auto index = [&](std::uint32_t face) {
      const auto at = std::lower_bound(chart.faces.begin(), chart.faces.end(), face);
      return static_cast<std::size_t>(at - chart.faces.begin());
    };
    const auto has = [&](std::uint32_t face) {
      return std::binary_search(chart.faces.begin(), chart.faces.end(), face);
    };
    std::vector<std::uint8_t> half(chart.faces.size(), 0);
    // Distinct elements make the order unique, whichever heap the standard library makes.
    std::priority_queue<Front, std::vector<Front>, std::greater<>> queue;
    queue.push({0, first, 1});
    queue.push({0, second, 2});
    while (!queue.empty()) {
      const Front front = queue.top();
      queue.pop();
      if (half[index(front.face)] != 0) continue;
      half[index(front.face)] = front.half;
      for (const std::uint32_t next : faces_.neighbours[front.face])
        if (next != kNone && has(next) && half[index(next)] == 0)
          queue.push(
              {front.cost + norm(faces_.centroid[next] - faces_.centroid[front.face]), next, front.half});
    }
    std::vector<Chart> halves(3, Chart{chart.axis, {}});
    for (std::size_t i = 0; i < half.size(); ++i) halves[half[i]].faces.push_back(chart.faces[i]);
    std::erase_if(halves, [](const Chart& part) { return part.faces.empty(); });
    return halves;
  }

  const Mesh& mesh_;
  const FaceGeometry& faces_;
};

}  // namespace

std::vector<Chart> split_overlaps(const Mesh& mesh, const FaceGeometry& faces, std::vector<Chart> charts) {
  const Splitter splitter(mesh, faces);
  std::vector<std::vector<Chart>> pieces(charts.size());
  parallel_for(charts.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) splitter.split(std::move(charts[c]), pieces[c]);
  });
  std::vector<Chart> result;
  for (std::vector<Chart>& list : pieces)
    for (Chart& piece : list) {
      if (piece.faces.size() == 1) piece.axis = faces.normal[piece.faces[0]];
      result.push_back(std::move(piece));
    }
  return result;
}

}  // namespace sdm::atlas
