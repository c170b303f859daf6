// Which face of a mesh is seen at each sample of a picture.
#pragma once

#include <sdm/mesh.h>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
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

/// kSamples² samples a pixel, in a regular grid that is stored in tiles of kTile² samples.
class DepthBuffer {
 public:
  static constexpr std::uint32_t kSamples = 2;
  static constexpr std::uint32_t kTile = 8;

  /// What is seen at a sample.
  struct Seen {
    float depth = -std::numeric_limits<float>::infinity();  ///< −∞ if there is no face
    std::uint32_t face = kNone;                             ///< the nearest; the first of equally near ones
  };
  /// Where a face is seen.
  struct Point {
    Vec3 weights;  ///< of its corners
    bool is_back;  ///< its corners are clockwise to the viewer
  };

  /// Draws all faces, from both sides. Cost: linear in faces, the rows that they cross and the samples that
  /// they cover; memory for the tiles that they touch.
  DepthBuffer(const Mesh& mesh, const Projection& projection);

  [[nodiscard]] std::uint32_t width() const { return width_; }  ///< samples
  [[nodiscard]] std::uint32_t height() const { return height_; }
  [[nodiscard]] const Seen& seen(std::uint32_t column, std::uint32_t row) const {
    return tile(column, row)[in_tile(column, row)];
  }
  /// The samples of the tile that contains a sample, in rows.
  using Tile = std::array<Seen, std::size_t{kTile} * kTile>;
  [[nodiscard]] const Tile& tile(std::uint32_t column, std::uint32_t row) const {
    return tiles_[tile_at_[place_of_tile(column, row)]];
  }
  /// Whether no face is seen in any sample of a tile.
  [[nodiscard]] bool is_empty(const Tile& tile) const { return &tile == &tiles_[kEmpty]; }
  /// The point of a face at a place, in samples.
  [[nodiscard]] Point point(const Vec2& at, const Triangle& triangle) const;

 private:
  static constexpr std::uint32_t kEmpty = 0;  // the tile of which nothing is seen

  /// The samples around a face, and the limits of its depth.
  struct Extent {
    double begin, end;  ///< columns
    std::uint32_t first_column, end_column, first_row, end_row;
    double farthest, nearest;
  };

  [[nodiscard]] std::size_t place_of_tile(std::uint32_t column, std::uint32_t row) const {
    return std::size_t{row / kTile} * tiles_across_ + column / kTile;
  }
  [[nodiscard]] static std::size_t in_tile(std::uint32_t column, std::uint32_t row) {
    return std::size_t{row % kTile} * kTile + column % kTile;
  }
  /// Twice the area in square samples; positive if the viewer sees the back, as rows count downwards.
  [[nodiscard]] double doubled_area(const Triangle& triangle) const;
  void draw_all(const Mesh& mesh);
  void draw(std::uint32_t face, const Triangle& triangle, const Extent& extent);
  [[nodiscard]] std::optional<Extent> extent_of(const Triangle& triangle) const;
  /// The least depth in each tile.
  [[nodiscard]] std::vector<float> farthest_in_tiles() const;
  /// Whether nearer faces have been drawn at all samples.
  [[nodiscard]] bool is_hidden(const Extent& extent, const std::vector<float>& farthest) const;

  std::uint32_t width_, height_, tiles_across_;
  std::vector<Vec3> corners_;           // x and y in samples, and depth, of each vertex
  std::vector<std::uint32_t> tile_at_;  // of each place of the grid, in tiles_
  std::vector<Tile> tiles_;             // kEmpty and those that were drawn into
};

}  // namespace sdm::io
