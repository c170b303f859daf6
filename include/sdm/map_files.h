/// Writing maps and what belongs to them: EXR, pictures, models, pages, report.json and distance fields;
/// tables of tolerances; and stored shapes, so that a program that starts does not build them again. Those of
/// files throw an sdm::Error that names the file and the fault.
///
/// report.json is the one form in which files, pages and programs get a Summary. Its keys are documented in
/// docs/report.md. Functions named _json return JSON text; NaN and infinity are null, and bytes of file names
/// that are not UTF-8 are dropped.
///
/// Threads: the functions may be called concurrently, unless two of them write the same file.
#pragma once

#include <sdm/doubts.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/mesh_attributes.h>
#include <sdm/mesh_edit.h>
#include <sdm/mesh_files.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/shape.h>
#include <sdm/sites.h>
#include <sdm/statistics.h>
#include <sdm/summary.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>
#include <sdm/types.h>
#include <sdm/volume.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace sdm {

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
/// numbers only, so the faces of such vertices form a primitive without `_DISTANCE`. The units m, cm, mm, um,
/// in and ft scale the node to metres; with others or none the node is not scaled.
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
/// its box. The page states each of these. `vertex_distances`: as for write_glb. Also throws sdm::Error if
/// the map or the distances belong to another surface, and if can_write_html() is false. Cost: linear, some
/// tens of milliseconds for 1024² texels.
SDM_API void write_html(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
                        std::span<const float> vertex_distances, const std::string& report,
                        const HtmlOptions& options = {});

/// A mesh of a report.
struct ReportedMesh {
  std::string file, transform{};
  MeshInfo info{};
  std::optional<WeldReport> weld{};            ///< if it was welded
  std::optional<Tessellation> tessellation{};  ///< if its file is CAD
  std::string xxh3{};                          ///< of the file, as of file_xxh3(); empty: unknown
};

/// Wall-clock times in milliseconds; nothing where none was taken.
struct ReportTimes {
  std::optional<double> import{}, atlas{}, sites{}, map{}, output{}, total{};
};

template <>
inline constexpr std::tuple kFields<ReportTimes>{Field{"import", &ReportTimes::import, "Reading the meshes."},
                                                 Field{"atlas", &ReportTimes::atlas, "Making the atlas."},
                                                 Field{"sites", &ReportTimes::sites, "Making the sites."},
                                                 Field{"map", &ReportTimes::map, "Computing the map."},
                                                 Field{"export", &ReportTimes::output, "Writing the files."},
                                                 Field{"total", &ReportTimes::total, "All together."}};

/// What a map was computed from, and how.
struct MapReport {
  ReportedMesh on{};               ///< that carries the map
  ReportedMesh to{};               ///< without meaning if Summary::of_itself
  bool on_o1 = true;               ///< `on` is O1
  std::optional<bool> embedded{};  ///< `to` does not intersect itself; if it has an inside
  std::string engine{};
  std::optional<double> precision{};  ///< that was asked for
  std::optional<int> udim{};          ///< the tile of the surface, if it is one
  std::size_t cut_faces = 0;          ///< of `on`, that cross the border of a texture that repeats
  ReportTimes time_ms{};
};

/// Returns report.json of a map: `report`, the atlas of the surface, and summary_json().
[[nodiscard]] SDM_API std::string report_json(const MapReport& report, const Surface& surface,
                                              const Summary& summary);
/// Returns the keys that a summary has in a report.
[[nodiscard]] SDM_API std::string summary_json(const Summary& summary);
/// Returns the value of `o1`, `o2` or `mesh`.
[[nodiscard]] SDM_API std::string mesh_json(const ReportedMesh& mesh);
/// Returns what map.exr states of a map, for ExrOptions::attributes: the meshes of the report, the sign, what
/// the distances are to unless to the closest point, and the units.
[[nodiscard]] SDM_API std::vector<std::pair<std::string, std::string>> exr_attributes(
    const MapReport& report, const DistanceMap& map, const std::string& units);
/// Returns the value of `tessellation`.
[[nodiscard]] SDM_API std::string tessellation_json(const Tessellation& tessellation);

/// The names and extensions of the formats of write_field(), for messages and help texts.
[[nodiscard]] SDM_API std::string field_format_names();
/// Throws sdm::Error unless the file has the extension of a format (in capitals or not), before there is a
/// field to write.
SDM_API void check_field_format(const std::filesystem::path& file);

/// Writes a field in the format of the file's extension; the file appears whole or not at all. Points without
/// a value are NaN, except in OpenVDB. Throws sdm::Error as check_field_format does, if the arrays of the
/// field do not fit its grid, or if the file cannot be written. Cost: linear.
///
/// .npy  NumPy: distances of shape dims, float32, the first index along x (in memory, x varies fastest). Has
///       neither origin nor spacing.
/// .vti  VTK ImageData, for ParaView: the point data `distance`, and `site` and `site_type` if the field has
///       them; raw appended data.
/// .vdb  OpenVDB: the grid `distance`, float, with a transform from the indices of points to the coordinates
///       of the mesh. Points with a value are active; the others have the maximum distance as their value
///       (the background, also outside of the grid), or, without one, the largest distance. A signed field
///       with a maximum distance of at least the largest spacing is a level set, with the negated maximum
///       distance at points beyond it that are inside O2; OpenVDB's tools for level sets also need cubic
///       cells.
SDM_API void write_field(const std::filesystem::path& file, const DistanceField& field);

/// Writes a shape, some twenty times the size of its mesh; the file appears whole or not at all. Throws
/// sdm::Error if it cannot be written. Cost: linear.
SDM_API void write_shape(const std::filesystem::path& file, const Shape& shape);

/// What is checked of a file.
struct ReadShapeOptions {
  /// Whether write_shape() certainly wrote the file, so that only damage is looked for: see StoredShape.
  bool trusted = false;
};

/// Reads a shape that write_shape() wrote, in a small part of the time of building it: its arrays are views
/// of the file, which is mapped into memory, so that processes that read the same file share it. All results
/// are those of the shape that was written, to the bit. The file may be deleted, renamed or written anew by
/// write_shape() while the shape exists, but not changed in place by other programs. Throws sdm::Error if it
/// cannot be read, if another version of sdm has written it, or if it is incomplete or damaged. A file that
/// is not trusted may come from anyone; see Shape::Shape(StoredShape). Cost: linear, all cores.
[[nodiscard]] SDM_API Shape read_shape(const std::filesystem::path& file,
                                       const ReadShapeOptions& options = {});

/// Reads the tolerances of groups: CSV with the header "group,lower,upper", or a JSON array of objects with
/// these keys. A name with a comma stands between quotation marks in CSV. With the header
/// "group;lower;upper", semicolons separate, and the decimal mark may be a comma. A side without a limit is
/// empty, in JSON null or left out. Throws sdm::Error, naming the file and the line, for a limit that is no
/// finite number, a lower limit above the upper one, a row without a limit, a group without a name or with
/// two rows, and a table without rows.
[[nodiscard]] SDM_API std::vector<GroupTolerance> read_tolerance_table(const std::filesystem::path& file);

}  // namespace sdm
