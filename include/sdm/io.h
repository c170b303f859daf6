/// Reading meshes and writing maps. Every function throws an sdm::Error that names the file and the fault.
///
/// Threads: the functions may be called concurrently, unless two of them write the same file.
#pragma once

#include <sdm/api.h>
#include <sdm/channels.h>
#include <sdm/coverage.h>
#include <sdm/group_verdicts.h>
#include <sdm/map.h>
#include <sdm/material.h>
#include <sdm/mesh.h>
#include <sdm/mesh_attributes.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/part_statistics.h>
#include <sdm/statistics.h>
#include <sdm/summary.h>
#include <sdm/surface.h>
#include <sdm/temporal_maps.h>
#include <sdm/tessellation.h>
#include <sdm/tolerance.h>
#include <sdm/transform.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace sdm {

/// Reads OBJ, PLY, STL, OFF, glTF/GLB, 3DS, or STEP and IGES if sdm was built with SDM_BUILD_CAD. The format
/// is detected from the content, then from the extension. Polygons are triangulated, all meshes of the file
/// are merged into one, and glTF's nodes, instances, default morph weights and skins are applied. Vertices
/// used by faces keep their order; bit-identical positions are welded. The result is valid in the sense of
/// validate(). It has texture coordinates if every corner of the file has; what else was left out is in
/// MeshFile::notes. STEP and IGES are tessellated as MeshFileOptions has it, in millimetres, see
/// MeshFile::tessellation; one such file is read at a time, and a deflection or an angle that is not positive
/// is an error, too.
[[nodiscard]] SDM_API Mesh read_mesh(const std::filesystem::path& file);

/// The vertices and polygons of a file as they are stored, before welding and triangulation. Those of the
/// nodes of glTF are transformed and concatenated; every corner of a triangle of STL is a vertex.
struct FileVertices {
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> mesh_vertex;  ///< of each, the vertex of the mesh; kNone if no face uses it
  std::vector<std::uint32_t> corners;      ///< the vertex of each corner, polygon after polygon
  std::vector<std::uint32_t> ends;         ///< for each polygon, one past its last corner
};

/// A mesh, and what its file says about it.
struct MeshFile {
  Mesh mesh;                     ///< as of read_mesh()
  std::vector<FaceNames> names;  ///< one entry for each kind that the file has
  /// What was left out or may be wrong, a sentence each: texture coordinates that some corners lack, a count
  /// that is not that of the file, text without its end.
  std::vector<std::string> notes{};
  std::optional<FileVertices> vertices{};
  std::optional<Tessellation> tessellation{};  ///< of STEP and IGES
  std::string xxh3{};                          ///< as of file_xxh3()
  std::vector<MeshAttribute> attributes{};     ///< of glTF, OBJ and PLY
  std::vector<Material> materials{};           ///< of glTF, and of the MTL files of OBJ
  std::vector<TextureFile> textures{};         ///< that these refer to
  /// The number of each triangle's material, or kNone; empty if there are no materials.
  std::vector<std::uint32_t> face_materials{};
};

/// Options of read_mesh_file().
struct MeshFileOptions {
  bool vertices = false;  ///< keep the vertices of the file: up to six times the memory of the mesh for STL
  TessellationOptions tessellation{};  ///< of STEP and IGES; other files consist of polygons
  bool attributes = false;             ///< read MeshFile::attributes, materials and textures
};

/// Reads a mesh as read_mesh() does, with the names of its faces.
[[nodiscard]] SDM_API MeshFile read_mesh_file(const std::filesystem::path& file,
                                              const MeshFileOptions& options = {});

/// Returns XXH3 with 64 bits of the bytes of a file, as 16 hexadecimal digits: what `xxhsum -H3` prints.
/// Files that it refers to, such as the .bin of glTF, do not take part. Cost: linear, less than that of
/// reading.
[[nodiscard]] SDM_API std::string file_xxh3(const std::filesystem::path& file);

/// The names of the formats that read_mesh supports, separated by commas, for messages and help texts.
[[nodiscard]] SDM_API std::string mesh_format_names();

/// Reads a 4×4 matrix, row by row, with the last row 0 0 0 1: 16 numbers as text, separated by spaces, commas
/// or line ends, with comments after '#'; an NPY array of shape (4, 4), float32 or float64; or JSON with the
/// rows as "matrix", such as alignment.json, or the same in an object "alignment", as in report.json. Also
/// throws sdm::Error for numbers that are not finite, and for a singular matrix.
[[nodiscard]] SDM_API Transform read_matrix(const std::filesystem::path& file);

/// Writes the positions, in double precision, the triangles and, if the mesh has them, the texture
/// coordinates of corners as binary PLY; read_mesh returns them bit-identical.
SDM_API void write_ply(const std::filesystem::path& file, const Mesh& mesh);

/// Writes a mesh in the format that the extension names: .ply as write_ply() does; .obj with all digits;
/// .stl, binary, without texture coordinates; .glb. The latter two keep positions, and GLB texture
/// coordinates, in single precision. Also throws sdm::Error for another extension.
SDM_API void write_mesh(const std::filesystem::path& file, const Mesh& mesh);
/// Whether write_mesh() rounds positions to float. Throws sdm::Error as it does for another extension.
[[nodiscard]] SDM_API bool is_written_in_single_precision(const std::filesystem::path& file);

/// The axis of the mesh that points up in model.glb, whose own vertical axis is y.
enum class UpAxis { y, z };

template <>
inline constexpr std::array kWords<UpAxis>{"y", "z"};

/// Options of pictures and coloured models.
struct PictureOptions {
  Colormap colormap = Colormap::automatic;
  /// The distances at the ends of the colour scale; values beyond them have the colours of the ends. Default:
  /// see fixed_colors().
  std::optional<std::array<double, 2>> range{};
  std::optional<Tolerance> tolerance{};  ///< bands: green within the tolerance, by side out of it
  std::string units{};                   ///< shown in the legend: "mm", ...
  double accuracy = 0;                   ///< error of the distances: a range from the map is at least as long
  /// The most pixels a side of pictures and of the model's texture. If there are more texels, one pixel shows
  /// one texel of a square of them.
  std::uint32_t largest = 2048;
  UpAxis up = UpAxis::y;  ///< model.glb: z turns the model, so that viewers show it upright
  bool unlit = false;     ///< model.glb: without shading, so that a pixel has exactly the colour of its value
  std::optional<Verdict> verdict{};  ///< views.png: stated beside the scale bar
  /// views.png: a face has bands of what the rows that name it accept, besides `tolerance`, so that what
  /// fails is seen; faces that none judges are beige. Names are those of the faces of O1. Without either: one
  /// scale.
  std::span<const GroupTolerance> table{};
  std::span<const FaceNames> names{};
};

inline constexpr const char* kUpText = "The axis of the meshes that points up.";

template <>
inline constexpr auto kOptions<PictureOptions> = std::tuple_cat(
    kColorOptions<PictureOptions>,
    std::tuple{
        Option{
            .name = "units",
            .member = &PictureOptions::units,
            .text = "Units of the meshes, for the legend; m, cm, mm, um, in, ft also scale models to metres.",
            .value = "NAME"},
        Option{.name = "size",
               .member = &PictureOptions::largest,
               .text = "The most pixels a side of the pictures and of the model's texture; of a larger map, "
                       "they show some texels.",
               .range = {16, 32768},
               .unit = "pixels",
               .value = "N"},
        Option{.name = "up", .member = &PictureOptions::up, .text = kUpText},
        Option{.name = "unlit",
               .member = &PictureOptions::unlit,
               .text = "Models without shading, in exactly the colours of the scale."}});

/// Returns `options` with the colormap and the range that color_range() chooses for them on a map with these
/// statistics, for pictures that share a scale. Errors and cost as of color_range().
[[nodiscard]] SDM_API PictureOptions fixed_colors(const PictureOptions& options,
                                                  const DistanceStatistics& distances);
/// Returns `options` with these colours.
[[nodiscard]] SDM_API PictureOptions fixed_colors(const PictureOptions& options, const ColorRange& colors);
/// Returns the colour of a distance in sRGB, by options that fixed_colors() returned; of NaN, that of samples
/// without a value. Cost: O(1).
[[nodiscard]] SDM_API std::array<std::uint8_t, 3> color_of(const PictureOptions& fixed, double distance);
/// Returns what the options choose of the colours.
[[nodiscard]] SDM_API ColorChoice color_choice(const PictureOptions& options);

/// The distances of the vertices of a file, in its order and count, to join them to it. `vertex_distances`:
/// one per vertex of the mesh that the file was read as. Vertices of no face, and those whose distance is
/// not finite, have no value: NaN, in CSV an empty field. Positions are those of the file, in double
/// precision. All also throw sdm::Error if the distances belong to another mesh. Cost: linear.
///
/// Binary PLY: x, y, z, and the distance twice, as `quality` and `distance` (float); the polygons of the
/// file.
SDM_API void write_vertices_ply(const std::filesystem::path& file, const FileVertices& vertices,
                                std::span<const float> vertex_distances);
/// Columns vertex (numbered from 0), x, y, z, distance; all digits.
SDM_API void write_vertices_csv(const std::filesystem::path& file, const FileVertices& vertices,
                                std::span<const float> vertex_distances);
/// Shape (vertices,), float32.
SDM_API void write_vertices_npy(const std::filesystem::path& file, const FileVertices& vertices,
                                std::span<const float> vertex_distances);
/// VTK PolyData in XML: points, the polygons of the file, and the point data `distance` (Float32).
SDM_API void write_vertices_vtp(const std::filesystem::path& file, const FileVertices& vertices,
                                std::span<const float> vertex_distances);

/// Options of write_exr().
struct ExrOptions {
  std::vector<std::string> layers = default_channel_layers();  ///< of channel_layers()
  std::span<const std::uint8_t> boundary{};  ///< of boundary_mask(), or empty: channel boundary.M (0 or 1)
  const Sites* sites = nullptr;              ///< the sites of the map, for layers that need them
  /// Names, of at most 31 bytes, and values of string attributes of the file, such as the units.
  std::vector<std::pair<std::string, std::string>> attributes{};
};

/// map.exr: the planes of the channels() whose layer is in the file by default, and coverage.A. Values are
/// dilated into the gutters, by four texels or AtlasOptions::gutter, if that is more; coverage.A is the
/// coverage before dilation. Texels without a value hold NaN and 0xFFFFFFFF; in self maps, texels with
/// nothing in range hold +∞, 0 and 0xFFFFFFFF. Also throws sdm::Error for an
/// unknown layer, and if the sites are missing or those of another map.
SDM_API void write_exr(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
                       const ExrOptions& options = {});
/// The same for statistics over time: channels min.D, mean.D, max.D (FLOAT) and coverage.A.
SDM_API void write_exr(const std::filesystem::path& file, const Surface& surface, const TemporalMaps& maps);

/// Writes one number per texel, such as NearestMap::body, as NPY of shape (rows, resolution), uint32, row 0
/// at the top. Also throws sdm::Error unless they are one or more whole rows of `resolution` numbers.
SDM_API void write_npy(const std::filesystem::path& file, std::uint32_t resolution,
                       std::span<const std::uint32_t> values);

/// atlas_distance.png: the colour-mapped distance, with a legend of range and units.
SDM_API void write_distance_png(const std::filesystem::path& file, const Surface& surface,
                                const DistanceMap& map, const PictureOptions& options = {});
/// atlas_voronoi.png: one colour per closest site.
SDM_API void write_voronoi_png(const std::filesystem::path& file, const Surface& surface,
                               const DistanceMap& map, const PictureOptions& options = {});
/// atlas_direction.png: the unit vector to O2, (x, y, z) → (r, g, b) by (1 + x)/2.
SDM_API void write_direction_png(const std::filesystem::path& file, const Surface& surface,
                                 const DistanceMap& map, const PictureOptions& options = {});

/// views.png: six shaded views of O1, coloured by distance, at one scale: front, back, left, right, top and
/// bottom, as seen with `options.up` as the vertical axis, with a colour bar, a scale bar, and a ring around
/// the smallest and the largest distance of all texels and vertices where O1 does not hide them; a dashed
/// ring, "behind", in one view if it hides one in all of them. `other`: O2, which is drawn pale behind and
/// beside O1, and as a veil in front of it; null: O1 only. `vertex_distances`: one per vertex of
/// surface.mesh(), not finite where there is none. Drawn without OpenGL. Also throws sdm::Error if the map or
/// the distances belong to another surface. Cost: linear in texels and faces, some 0.2 s for the pixels.
SDM_API void write_views_png(const std::filesystem::path& file, const Surface& surface,
                             const DistanceMap& map, std::span<const float> vertex_distances,
                             const Mesh* other = nullptr, const PictureOptions& options = {});

/// Where a view is seen from, and what else it shows.
struct ViewOptions {
  /// The direction from the part to the viewer: to the right, up (PictureOptions::up) and to the front. Not
  /// zero.
  Vec3 towards{0.7, 0.5, 1};
  std::uint32_t width = 1200, height = 900;  ///< pixels of the view, from 64 to 8192; the legend is beside it
  const Mesh* other = nullptr;               ///< O2, which is drawn pale; null: O1 only
  /// One distance per vertex of O2, for the colours of O2 at the same scale; empty: O2 is pale.
  std::span<const float> other_distances{};
  bool legend = true;
};

/// One shaded view of O1, coloured by distance, with its legend; all of O1 and of O2 fits. Drawn without
/// OpenGL. Errors as of write_views_png(), also for a zero direction, another size, and distances of another
/// mesh. Cost: linear in texels, faces and pixels.
SDM_API void write_view_png(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
                            std::span<const float> vertex_distances, const ViewOptions& view = {},
                            const PictureOptions& options = {});

/// The distances of the darkest and the brightest value of a texture.
struct TextureRange {
  double lower = 0, upper = 1;
};

/// Returns `options` with the range that write_distance_texture() chooses on a map with these statistics, for
/// textures that share a scale: that of all distances. Errors and cost as of color_range().
[[nodiscard]] SDM_API PictureOptions texture_range(const PictureOptions& options,
                                                   const DistanceStatistics& distances);
/// distance_texture.png: the distance of every texel as 16-bit grey, without legend or colours, at the size
/// of the atlas: lower + value / 65535 · (upper − lower). The range is that of options.range, by default that
/// of all distances, symmetric about 0 if the colormap is diverging; distances beyond it are clamped. Gutters
/// are filled as in map.exr; texels beyond them, or without a value, are 0. Returns the range.
SDM_API TextureRange write_distance_texture(const std::filesystem::path& file, const Surface& surface,
                                            const DistanceMap& map, const PictureOptions& options = {});
/// distance_texture.json: the range of a texture, with its name and units.
SDM_API void write_texture_range(const std::filesystem::path& file, const std::string& texture,
                                 const TextureRange& range, const std::string& units = {});

/// A curve of a plot: one value per position on the axis; NaN leaves a gap.
struct Curve {
  std::string name;
  std::vector<double> values;
};
/// Curves over a common axis, with a title and, if there are several, their names.
struct PlotPanel {
  std::string title;
  std::vector<Curve> curves;
};
/// plot.png: panels stacked over a common axis with the label `axis` and the positions `places`. Also throws
/// sdm::Error unless every curve has one value per position.
SDM_API void write_plot_png(const std::filesystem::path& file, const std::string& axis,
                            std::span<const double> places, std::span<const PlotPanel> panels);

/// model.glb: O1 with the coloured map as the base-colour texture of a matt material, normals that are smooth
/// except across edges of more than 40°, and `_DISTANCE` per vertex; any viewer displays it.
/// `vertex_distances`: one per vertex of surface.mesh(), not finite where there is none. glTF allows finite
/// numbers only, so the faces of such vertices form a primitive without
/// `_DISTANCE`. The units m, cm, mm, um, in and ft scale the node to metres; with others or none the node is
/// not scaled.
SDM_API void write_glb(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
                       std::span<const float> vertex_distances, const PictureOptions& options = {});

/// The places that a page lists.
enum class ListedPlaces : std::uint8_t {
  deviating,  ///< where O1 deviates most: those of the report
  least,      ///< thinnest_texels(): for wall thickness, and for the distance of a mesh to itself
  largest,    ///< thickest_texels()
};

/// Options of write_html().
struct HtmlOptions {
  const Mesh* other = nullptr;            ///< O2, shown as a ghost; none: O1 only
  UpAxis up = UpAxis::y;                  ///< the axis of the meshes that points up
  const CoverageMap* coverage = nullptr;  ///< of `other`, on which it is drawn
  std::span<const FaceNames> names{};     ///< of the faces of O1: what a click on a group shows apart
  ListedPlaces places = ListedPlaces::deviating;
  // The size of the page, which grows with what it shows:
  std::uint32_t largest = 1024;              ///< the most texels a side; half from 200,000 triangles on
  std::size_t triangles = 400'000;           ///< the most of O1; others are shown by a coarser copy
  std::size_t triangles_of_other = 300'000;  ///< the most of O2; others are shown by their box
};

/// Whether write_html can write: whether sdm was built with SDM_BUILD_REPORT.
[[nodiscard]] SDM_API bool can_write_html();

/// report.html: one file that opens in a browser, from disk and without a network. It shows the verdict and
/// the numbers of `report`, the JSON text of report.json, and O1 in 3D, where every value under the cursor is
/// that of a texel of the map, bit-identical. Of larger maps than the options have, one texel of each square
/// is in the page; of O1 with more triangles, a coarser copy whose vertices have their own distances; of O2,
/// its box. The page states each of these. `vertex_distances`: as
/// for write_glb. Also throws sdm::Error if the map or the distances belong to another surface, and if
/// can_write_html() is false. Cost: linear, some tens of milliseconds for 1024² texels.
SDM_API void write_html(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
                        std::span<const float> vertex_distances, const std::string& report,
                        const HtmlOptions& options = {});

}  // namespace sdm
