// Which face of a mesh is seen at each sample of a picture.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace sdm::io {

/// A parallel projection. Pixels are counted from the upper left corner; depth grows towards the viewer, in
/// units of the mesh.
struct Projection {
  Vec3 right{1, 0, 0}, up{0, 1, 0}, towards{0, 0, 1};  ///< an orthonormal frame of the viewer
  Vec3 centre{};                                       ///< the point in the middle of the picture
  double scale = 1;                                    ///< pixels per unit of the mesh
  std::uint32_t width = 1, height = 1;                 ///< pixels

  /// x, y and depth of a point.
  [[nodiscard]] Vec3 operator()(const Vec3& point) const;
};

/// kSamples² samples a pixel, in a regular grid.
class DepthBuffer {
 public:
  static constexpr std::uint32_t kSamples = 2;

  /// Draws all faces, from both sides. Cost: linear in faces, the rows that they cross and the samples that
  /// they cover.
  DepthBuffer(const Mesh& mesh, const Projection& projection);

  [[nodiscard]] std::uint32_t width() const { return width_; }  ///< samples
  [[nodiscard]] std::uint32_t height() const { return height_; }
  /// The nearest face, kNone if there is none.
  [[nodiscard]] std::uint32_t face(std::size_t sample) const { return seen_[sample].face; }
  /// Its depth, −∞ if there is none.
  [[nodiscard]] float depth(std::size_t sample) const { return seen_[sample].depth; }
  /// The weights of the corners of a face at a sample.
  [[nodiscard]] Vec3 weights(std::size_t sample, const Triangle& triangle) const;
  /// Whether the viewer sees the back of a face: its corners are clockwise.
  [[nodiscard]] bool is_back(const Triangle& triangle) const;

 private:
  struct Seen {
    float depth = -std::numeric_limits<float>::infinity();
    std::uint32_t face = kNone;
  };

  void draw(std::uint32_t face, const Triangle& triangle);

  std::uint32_t width_, height_;
  std::vector<Vec3> corners_;  // x and y in samples, and depth, of each vertex
  std::vector<Seen> seen_;     // at each sample
};

}  // namespace sdm::io
