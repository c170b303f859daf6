/// The surface on which distances are measured (O1): a mesh with a texture atlas.
///
/// Threads: const functions of a Surface may be called concurrently, as may all maps of it; nothing else may
/// run beside refit() and edit().
#pragma once

#include <sdm/execution.h>
#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// How the faces of a mesh are laid out.
enum class AtlasKind {
  charts,     ///< clusters of faces with similar normals, each projected orthogonally
  triangles,  ///< pairs of adjacent triangles, each unfolded across the common edge: without distortion
  uv,         ///< the mesh's own texture coordinates
};

template <>
inline constexpr std::array kWords<AtlasKind>{"charts", "triangles", "uv"};

/// Options of a Surface.
struct AtlasOptions {
  AtlasKind kind = AtlasKind::charts;
  std::uint32_t resolution = 1024;  ///< texels per row, in [16, 32768]
  /// Texels per column, in [16, 32768]; by default as many as per row, as is necessary unless the kind is uv.
  /// Texels of an atlas of another shape are as high and as wide on the surface as the texture makes them.
  std::optional<std::uint32_t> rows{};
  /// charts: bounds the growth of lengths from atlas to surface; in (1, 100]. Where a mesh is so rough, as
  /// scans are, that most of the atlas would be gutters, charts follow the smoothed surface, and faces are
  /// stretched by up to 4, unless this is less than 1.1034.
  double max_stretch = 1.3;
  /// charts, triangles: free texels around each chart, not shared. All: values of files extend at least this
  /// far beyond the charts (see write_exr).
  std::uint32_t gutter = 1;
  /// uv: refuse faces that overlap in the texture. Otherwise a texel of several faces belongs to the first of
  /// their charts, and the other faces have no sample there.
  bool strict_uv = false;
  Progress progress{};
};

inline constexpr OptionRange kResolutionRange{16, 32768}, kGutterRange{0, 8192};
inline constexpr const char* kGutterText =
    "Free texels around each chart, and how far values extend beyond charts, if more than 4.";

template <>
inline constexpr auto kOptions<AtlasOptions> = std::tuple{
    Option{.name = "resolution",
           .member = &AtlasOptions::resolution,
           .text = "Texels along each side of the atlas.",
           .range = kResolutionRange,
           .unit = "texels",
           .value = "N"},
    Option{.name = "atlas",
           .member = &AtlasOptions::kind,
           .text =
               "How the surface is parametrised: few charts, pairs of triangles without distortion, or its "
               "own UVs."},
    Option{.name = "gutter",
           .member = &AtlasOptions::gutter,
           .text = kGutterText,
           .range = kGutterRange,
           .unit = "texels",
           .value = "N"},
    Option{.name = "strict_uv",
           .member = &AtlasOptions::strict_uv,
           .text = "Of the surface's own UVs: refuse coordinates outside of [0, 1] and faces that overlap in "
                   "the texture."},
    Option{.name = "max_stretch",
           .member = &AtlasOptions::max_stretch,
           .text =
               "Of charts: the largest stretch, the factor by which lengths grow from map to surface; from "
               "1.1034 on, up to 4 where noise of a scan would leave too little of the atlas.",
           .range = {.least = 1, .most = 100, .above = true},
           .value = "S"}};

namespace surface {
class SurfaceData;
}

/// O1: a mesh whose faces are laid out in a texture of resolution() · rows() texels. Faces do not overlap,
/// except for AtlasKind::uv, as the mesh has it.
///
/// Atlas coordinates (u, v) are in texels, u to the right, v *down* from the upper left corner of the image,
/// so that texel (x, y) has its centre at (x + 0.5, y + 0.5) and the index y * resolution + x. Every face has
/// an affine map M from its plane to the atlas; a texel belongs to the face that contains its centre, at most
/// one.
///
/// The samples of the surface are the centres of the texels that a face owns and, of each face with an area
/// that owns none, one point: every part of the area has a sample. These points have the indices from
/// resolution() · rows() on, in the order of the faces; pictures of the atlas do not show them. Where they
/// lie in their faces depends on the number of the face only, and is spread evenly over such faces: centroids
/// would average what faces smaller than a texel have at their corners, such as the noise of a scan.
class SDM_API Surface {
 public:
  /// Lays out the atlas. Throws sdm::Error when the mesh is unusable (see validate), when the resolution is
  /// out of range or too small for the charts, if there is not enough memory, and for AtlasKind::uv when
  /// coordinates are missing, lie outside [0, 1] (see wrap_uvs and uv_tile_mesh) or, with strict_uv, overlap
  /// (the message names two faces) or give a face with an area none in the texture, or cover the texture more
  /// than 64 times over and more than 2^30 texels (the message names the largest face). Faces without area
  /// belong to no chart; those without one in the texture only are a chart each, without a texel. Cost: O(n
  /// log n) for charts, then packing.
  explicit Surface(Mesh mesh, const AtlasOptions& options = {});
  /// Takes the atlas that stored_atlas() returned for a surface of the same mesh and options; nothing is laid
  /// out. Throws sdm::Error if the bytes belong to another mesh, to other options or to another version, or
  /// are damaged, and as above. Cost: linear, a small part of laying out.
  Surface(Mesh mesh, const AtlasOptions& options, std::span<const std::uint8_t> stored_atlas);
  ~Surface();
  Surface(Surface&&) noexcept;
  Surface& operator=(Surface&&) noexcept;

  /// Moves the vertices and keeps the triangles and the atlas: the samples of a face move affinely with it;
  /// the map of a face whose vertices do not move is bit-identical. Throws sdm::Error, and changes nothing,
  /// when the count differs or a coordinate is not finite or beyond 1e37. If there is not enough memory, it
  /// also throws, and changes nothing or leaves the object broken (see sdm/error.h). Cost: linear in faces,
  /// all cores.
  void refit(std::span<const Vec3> positions);

  /// Changes the mesh and keeps the atlas of all that stays: for every face that is neither removed nor
  /// added, atlas_corners(), chart and owned texels do not change; its map is bit-identical if its corners
  /// have the same positions as before, otherwise it is that of refit(). Texels of removed faces become free,
  /// and their charts keep their numbers. Added faces form charts of their own, of the options of the atlas
  /// (for `uv`: AtlasKind::charts), at the scale of the layout: texels per unit length of the added faces as
  /// they are now. They take free texels first; then rows() grows. Rows are only added at the bottom, so
  /// texel (x, y) keeps its index; those of faces without a texel change. sample_texels() changes; a
  /// SamplingBound must be built again.
  ///
  /// Throws sdm::Error, and changes nothing, as apply() does, if a chart of added faces is wider than the
  /// atlas, if more than 65535 rows would be needed, if no face would own a texel, and if there is not enough
  /// memory. Cost: by the size of the edit, plus copies of the mesh and its maps and a pass over the samples;
  /// over the texels where faces are added, and over the faces where vertices are moved; the first edit also
  /// rasterises all faces.
  void edit(const MeshEdit& edit);

  /// The atlas as bytes, without the mesh: for a cache. They belong to the mesh in its present shape, and
  /// can be used by the same version of sdm only, on any little-endian machine.
  /// Cost: linear.
  [[nodiscard]] std::vector<std::uint8_t> stored_atlas() const;

  /// The mesh in its present shape.
  [[nodiscard]] const Mesh& mesh() const;
  /// The kind of the atlas.
  [[nodiscard]] AtlasKind atlas_kind() const;
  /// Texels per row.
  [[nodiscard]] std::uint32_t resolution() const;
  /// Texels per column: AtlasOptions::rows, by default resolution(), until edits add rows.
  [[nodiscard]] std::uint32_t rows() const;

  /// The face that owns each texel, or kNone; resolution() · rows() values.
  [[nodiscard]] std::span<const std::uint32_t> texel_faces() const;
  /// The face of each value of a map: texel_faces(), then the faces that own no texel, ascending.
  [[nodiscard]] std::span<const std::uint32_t> map_faces() const;
  /// The indices of all samples, in an order that keeps consecutive ones close together on the surface.
  [[nodiscard]] std::span<const std::uint32_t> sample_texels() const;
  /// texel_point() of each of sample_texels(). Computed by each call. Cost: linear in samples, all cores.
  [[nodiscard]] std::vector<Vec3> sample_points() const;
  /// The point of a sample: of an owned texel's centre, M⁻¹ of its face; of an index from
  /// resolution() · rows() on, the one of its face.
  [[nodiscard]] Vec3 texel_point(std::uint32_t texel) const;

  /// The number of charts.
  [[nodiscard]] std::size_t chart_count() const;
  /// The chart of each face, or kNone for a face without area.
  [[nodiscard]] std::span<const std::uint32_t> face_charts() const;
  /// M: atlas coordinates of a point of the face's plane. The face must have a chart.
  [[nodiscard]] Vec2 to_atlas(std::uint32_t face, const Vec3& point) const;
  /// M of the face's vertices. The face must have a chart.
  [[nodiscard]] std::array<Vec2, 3> atlas_corners(std::uint32_t face) const;
  /// M⁻¹: the point of the face's plane at atlas coordinates. The face must have a chart.
  [[nodiscard]] Vec3 to_surface(std::uint32_t face, const Vec2& uv) const;
  /// The edges of a texel on the surface: the columns ∂p/∂u and ∂p/∂v of M⁻¹. The face must have a chart.
  [[nodiscard]] std::array<Vec3, 2> texel_edges(std::uint32_t face) const;

  /// AtlasOptions::gutter.
  [[nodiscard]] std::uint32_t gutter() const;
  /// uv: the texels whose centre lies in a face that does not own it, by more than rounding; each as often as
  /// it does. 0 for other atlases.
  [[nodiscard]] std::size_t overlapping_texels() const;
  /// uv: the faces that have an area on the surface but none in the texture, and so no texel. 0 for other
  /// atlases. Cost: linear in faces.
  [[nodiscard]] std::size_t faces_without_uv_area() const;

  /// The number of texels that a face owns.
  [[nodiscard]] std::size_t owned_texels() const;
  /// owned_texels() divided by the number of all texels.
  [[nodiscard]] double utilisation() const;
  /// The largest factor by which a length grows from atlas to surface, relative to the atlas's own scale (for
  /// `uv`: the scale at which areas agree in total). Exactly 1 for `triangles`, at most max_stretch for
  /// `charts` unless the mesh is rough (see AtlasOptions). Refers to the mesh that the atlas was laid out
  /// for, before any refit.
  [[nodiscard]] double max_stretch() const;

 private:
  friend const surface::SurfaceData& internals(const Surface&);

  std::unique_ptr<surface::SurfaceData> data_;
};

}  // namespace sdm
