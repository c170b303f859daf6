#include "io/page/player/drawn_body.h"

#include <sdm/mesh_edit.h>

#include <algorithm>
#include <cmath>

namespace sdm::io {
namespace {

constexpr double kFew = 6000;  // triangles
constexpr std::uint32_t kMostParts = 24;

std::vector<Triangle> present(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  std::ranges::remove_copy_if(mesh.triangles, std::back_inserter(triangles), is_removed);
  return triangles;
}

}  // namespace

DrawnBody::DrawnBody(const Mesh& mesh) : of_body_(present(mesh)) {
  const auto count = static_cast<double>(std::max<std::size_t>(1, of_body_.size()));
  parts_ = std::clamp(static_cast<std::uint32_t>(std::sqrt(kFew / count)), 1u, kMostParts);
  if (parts_ == 1) {
    std::vector<std::uint32_t> number(mesh.positions.size(), kNone);
    drawn_ = of_body_;
    for (Triangle& t : drawn_)
      for (std::uint32_t& v : t) {
        if (number[v] == kNone) {
          number[v] = static_cast<std::uint32_t>(used_.size());
          used_.push_back(v);
        }
        v = number[v];
      }
    vertices_ = used_.size();
    return;
  }
  // Rows of vertices parallel to the side from the second to the third corner; row i has i + 1 of them.
  for (std::size_t face = 0; face < of_body_.size(); ++face)
    for (std::uint32_t row = 0; row <= parts_; ++row) {
      const auto before = static_cast<std::uint32_t>(vertices_) - row;  // of the row before
      for (std::uint32_t k = 0; k < row; ++k) {
        const auto here = static_cast<std::uint32_t>(vertices_) + k;
        drawn_.push_back({before + k, here, here + 1});
        if (k + 1 < row) drawn_.push_back({before + k, here + 1, before + k + 1});
      }
      vertices_ += row + 1;
    }
}

bool DrawnBody::fits(const Mesh& mesh) const {
  return present(mesh) == of_body_;
}

Mesh DrawnBody::mesh(std::span<const Vec3> positions) const {
  Mesh mesh;
  mesh.triangles = drawn_;
  mesh.positions.reserve(vertices_);
  if (parts_ == 1) {
    for (const std::uint32_t v : used_) mesh.positions.push_back(positions[v]);
    return mesh;
  }
  for (const Triangle& t : of_body_)
    for (std::uint32_t row = 0; row <= parts_; ++row)
      for (std::uint32_t k = 0; k <= row; ++k) {
        const double a = parts_ - row, b = row - k, c = k;
        mesh.positions.push_back((1.0 / parts_) *
                                 (a * positions[t[0]] + b * positions[t[1]] + c * positions[t[2]]));
      }
  return mesh;
}

}  // namespace sdm::io
