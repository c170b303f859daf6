/// Baking: textures of O1 with what O2 has at the points that belong to O1's texels: its materials, textures
/// and colours, and its geometry, which is normals, tangent-space normals, displacements, positions, ambient
/// occlusion, thickness, and numbers of faces and materials. A texel is the mean of one or several samples,
/// on a regular grid.
///
/// Threads: the functions may be called concurrently, also with the same surface, sites and matches.
#pragma once

#include <sdm/execution.h>
#include <sdm/match.h>
#include <sdm/measure.h>
#include <sdm/mesh.h>
#include <sdm/mesh_attributes.h>
#include <sdm/options.h>
#include <sdm/rays.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace sdm {

/// Rows of samples; each texel has side · side of them.
struct SampleGrid {
  std::uint32_t resolution = 0;  ///< samples per row, a multiple of the side
  std::uint32_t side = 1;        ///< of a texel, in samples

  /// Texels per row.
  [[nodiscard]] std::uint32_t texels() const { return resolution / side; }
};

/// Values as the mean of samples makes them, and how much of each texel they are from.
struct TexelMeans {
  std::vector<float> values;    ///< NaN for texels without a sample that has values
  std::vector<float> coverage;  ///< for each texel the share, from 0 to 1, of its samples that have values
};

/// What the mean of samples is.
enum class SampleKind : std::uint8_t {
  numbers,    ///< the arithmetic mean: of colours in linear light, that of the light
  directions  ///< its direction, of length 1: of three components that are unit vectors
};

/// Returns the side of the square of so many samples a texel: the root of 1, 4, 9 and so on up to 64; nothing
/// for other numbers.
[[nodiscard]] SDM_API std::optional<std::uint32_t> sample_side(std::int64_t samples);

/// Returns the layout of samples, side · side for each texel of a layout: that of a finer texture, in which
/// charts of different texels do not meet. Throws sdm::Error if it has fewer texels per row than a surface
/// may have, or more samples.
[[nodiscard]] SDM_API AtlasOptions sample_layout(const AtlasOptions& texels, std::uint32_t side);

// The next two throw sdm::Error unless the samples are whole rows of texels, and if there is not
// enough memory. Their cost is linear in samples, all cores.

/// Returns the means of samples of `components` numbers each. Those that are not all finite count as none.
/// Directions that cancel out are those of the first sample.
[[nodiscard]] SDM_API TexelMeans mean_of_samples(const SampleGrid& grid, std::size_t components,
                                                 std::span<const float> samples,
                                                 SampleKind kind = SampleKind::numbers);

/// The same for samples of a surface, side · side for each texel, without mixing what does not belong
/// together: of the samples of a texel that have values, those count that are in the chart of the face at its
/// centre and, with `normals`, those that the model is drawn with, where these differ by up to 20° from that
/// at the centre. That face is one of those that have a sample. Charts of texture coordinates may touch then,
/// and normals in tangent space are not averaged over a fold, whose faces have other tangents. `coverage` is
/// that of all samples. Also throws sdm::Error if the normals do not fit.
[[nodiscard]] SDM_API TexelMeans mean_of_samples(const Surface& surface, std::uint32_t side,
                                                 std::size_t components, std::span<const float> samples,
                                                 SampleKind kind = SampleKind::numbers,
                                                 const MeshAttribute* normals = nullptr);

/// Returns the number that most samples of each texel have, the least one of several; kNone, which counts as
/// none, for texels that have no other.
[[nodiscard]] SDM_API std::vector<std::uint32_t> most_frequent_samples(
    const SampleGrid& grid, std::span<const std::uint32_t> samples);

/// The textures of a material that can be baked.
enum class BakeChannel : std::uint8_t {
  base_color,  ///< red, green, blue, and alpha unless all is opaque: factor · texture · vertex colour
  metallic_roughness,  ///< roughness and metallic: factor · texture
  occlusion,           ///< the share of ambient light that arrives: 1 + strength · (texture − 1)
  emissive,            ///< red, green, blue: factor · texture
};

/// All of them, in this order.
inline constexpr BakeChannel kBakeChannels[] = {BakeChannel::base_color, BakeChannel::metallic_roughness,
                                                BakeChannel::occlusion, BakeChannel::emissive};

/// Returns the name of a channel, such as "base_color".
[[nodiscard]] SDM_API std::string_view name_of(BakeChannel channel);

/// Whether the values of a channel are colours, which pictures store in sRGB.
[[nodiscard]] constexpr bool is_color(BakeChannel channel) {
  return channel == BakeChannel::base_color || channel == BakeChannel::emissive;
}

/// How the faces of a mesh look: of a MeshFile its arrays, with the pictures decoded.
struct MeshLook {
  std::span<const Material> materials{};
  /// The material of each face, or kNone: that of Material(). Empty: kNone for all.
  std::span<const std::uint32_t> face_materials{};
  /// The pictures that materials refer to. An empty one (width 0): there is no such texture.
  std::span<const Image> pictures{};
  /// `color` multiplies base colours; `uv1`, `uv2`, ... are further texture coordinates, `uv0`
  /// the first ones if the mesh has none. Others are ignored.
  std::span<const MeshAttribute> attributes{};
};

/// Returns the channels that differ between points of the mesh: those with a texture, with factors that are
/// not the same for all faces, or with colours of vertices. Throws sdm::Error as bake() does. Cost: linear in
/// faces.
[[nodiscard]] SDM_API std::vector<BakeChannel> varying_channels(const Mesh& mesh, const MeshLook& look);

/// Returns the channels that are baked unless others are asked for: base_color, and the others of
/// varying_channels(). Errors and cost as there.
[[nodiscard]] SDM_API std::vector<BakeChannel> default_channels(const Mesh& mesh, const MeshLook& look);

/// Returns the material of the first face that has one, or Material(), without name and textures: the factors
/// of channels that do not differ. Its alpha_mode is `blend` or `mask` if that of any face is. Throws
/// sdm::Error for a number of a material that does not exist.
[[nodiscard]] SDM_API Material common_material(const MeshLook& look);

/// A surface for textures.
struct BakeAtlas {
  Surface surface;
  std::string fault;  ///< why its UVs are not used, such as "it has no UVs"; empty: they are
};

/// Lays a mesh out for textures: by its UVs if it has them, they lie in [0, 1], and at most 1 % of the texels
/// of faces lie in another one too; otherwise in charts. `options.kind` is ignored. Throws sdm::Error as
/// Surface does, and for a texture that is not square if the UVs cannot be used. Cost: that of one or two
/// surfaces.
[[nodiscard]] SDM_API BakeAtlas bake_atlas(const Mesh& mesh, const AtlasOptions& options = {});

/// Returns Surface::overlapping_texels() as a share of the texels of faces.
[[nodiscard]] SDM_API double overlap_of(const Surface& surface);

/// Options of bake().
struct BakeOptions {
  /// Whether texels without a match get values too, as of TransferOptions::fill; otherwise they hold NaN.
  bool fill = true;
  Progress progress{};
};

/// A channel of O1's texels.
struct BakedChannel {
  BakeChannel channel = BakeChannel::base_color;
  std::uint32_t resolution = 0;  ///< texels per row
  std::size_t components = 0;    ///< 3 or 4 of base_color, 2, 1, 3
  std::vector<float> values;     ///< row after row, from 0 to 1; colours in linear light
};

/// Returns the channels at the matches of the texels. A texture is averaged over what the texel covers of it:
/// the texel's edges, projected onto the plane of the face of O2 and carried to the texture by the face's
/// texture coordinates. Colours are averaged in linear light; colours of vertices are interpolated. Where
/// O2 has no texture coordinates for a texture, its factor alone counts.
///
/// Throws sdm::Error if the matches are not those of the surface, if a number of a face, a material or a
/// picture does not exist, for arrays of another mesh than that of the sites, and if there is not enough
/// memory; Cancelled. Cost: linear in texels and in pixels of the pictures that are used, all cores; twice
/// the memory of the pictures.
[[nodiscard]] SDM_API std::vector<BakedChannel> bake(const Surface& surface, const Sites& sites,
                                                     const TexelMatches& matches, const MeshLook& look,
                                                     std::span<const BakeChannel> channels,
                                                     const BakeOptions& options = {});

/// A channel at points: `components` numbers for each, as in BakedChannel.
struct LookValues {
  std::size_t components = 0;
  std::vector<float> values;
};

/// Returns a channel of a mesh at points of its faces. A texture is averaged over a square in the plane of
/// the face, whose middle is the point and whose sides are as long as `extent`, at least 0. Throws sdm::Error
/// as bake() does, and for a point of a face that does not exist. Cost: linear in points and in pixels of the
/// pictures that are used, all cores.
[[nodiscard]] SDM_API LookValues look_at(const Mesh& mesh, const MeshLook& look, BakeChannel channel,
                                         std::span<const SurfacePoint> points, double extent = 0);

/// Returns a channel with 8 bits a number, as textures of glTF have it: colours in sRGB, roughness in green
/// and metallic in blue beside a red of 1, occlusion in grey. Texels without a value are black. Throws
/// sdm::Error unless the values are whole rows of texels, of two numbers for roughness and metallic. Cost:
/// linear, all cores.
[[nodiscard]] SDM_API Image to_image(const BakedChannel& baked);

/// What can be baked of a mesh beside the textures of its materials.
enum class GeometryChannel : std::uint8_t {
  normal,             ///< tangent_space_normals() of matched_normals()
  object_normal,      ///< matched_normals()
  displacement,       ///< matched_displacements()
  position,           ///< matched_positions()
  ambient_occlusion,  ///< matched_occlusion()
  thickness,          ///< matched_thickness()
  face,               ///< TexelMatches::face
  material            ///< matched_materials()
};

/// All of them, in this order.
inline constexpr GeometryChannel kGeometryChannels[] = {
    GeometryChannel::normal,   GeometryChannel::object_normal,     GeometryChannel::displacement,
    GeometryChannel::position, GeometryChannel::ambient_occlusion, GeometryChannel::thickness,
    GeometryChannel::face,     GeometryChannel::material};

/// Returns the name of a channel, such as "object_normal".
[[nodiscard]] SDM_API std::string_view name_of(GeometryChannel channel);

/// Whether a channel has directions, of length 1.
[[nodiscard]] constexpr bool is_direction(GeometryChannel channel) {
  return channel == GeometryChannel::normal || channel == GeometryChannel::object_normal;
}

/// Whether a channel has whole numbers, kNone where there is none, which have no mean.
[[nodiscard]] constexpr bool is_number(GeometryChannel channel) {
  return channel == GeometryChannel::face || channel == GeometryChannel::material;
}

/// The numbers that a channel has for each texel.
[[nodiscard]] constexpr std::size_t components_of(GeometryChannel channel) {
  return is_direction(channel) || channel == GeometryChannel::position ? 3 : 1;
}

/// Options of bake_geometry().
struct GeometryOptions {
  /// Normals at the corners of O2's faces, for `normal` and `object_normal`; null: smooth_normals() of O2.
  const MeshAttribute* normals = nullptr;
  /// The materials of O2, with the pictures of normal textures, which bend its normals in the tangent space
  /// of MikkTSpace. Null, or in builds without MikkTSpace: normal textures are ignored.
  const MeshLook* look = nullptr;
  /// What the model of O1 is drawn with, for `normal`, which needs both.
  const MeshAttribute *drawn_normals = nullptr, *drawn_tangents = nullptr;
  /// Directions at the corners of O1's faces, for `displacement`; null: smooth_normals() of O1, so that
  /// displaced faces meet at their edges.
  const MeshAttribute* directions = nullptr;
  AmbientOcclusionOptions occlusion{};             ///< its progress is ignored
  ThicknessMethod method = ThicknessMethod::ball;  ///< of `thickness`
  ThicknessOptions thickness{};                    ///< its progress is ignored
  Progress progress{};
};

/// What is baked.
struct BakeSelection {
  std::vector<BakeChannel> look{};
  std::vector<GeometryChannel> geometry{};

  /// Whether the channel is baked.
  [[nodiscard]] bool has(GeometryChannel channel) const {
    return std::ranges::find(geometry, channel) != geometry.end();
  }
  friend bool operator==(const BakeSelection&, const BakeSelection&) = default;
};

/// Names of both kinds of channels, with a comma between two of them; read() has them in the order of the
/// library, and takes `normal` only if has_tangents().
template <>
struct OptionForm<BakeSelection> {
  static constexpr const char* kType = "texts";
  SDM_API static std::string needed();
  SDM_API static bool read(std::string_view text, const OptionRange& range, BakeSelection& value);
  SDM_API static std::string text(const BakeSelection& value);
  static bool allowed(const BakeSelection&, const OptionRange&) { return true; }
};

/// What programs that bake a pair of meshes can be asked for.
struct BakeRequest {
  std::optional<BakeSelection> channels{};  ///< nothing: default_channels()
  std::uint32_t resolution = 1024;          ///< as of AtlasOptions
  std::optional<std::uint32_t> rows{};      ///< the same
  std::uint32_t gutter = 1;                 ///< the same
  std::optional<AtlasKind> atlas{};         ///< nothing: as bake_atlas() chooses
  std::uint32_t samples = 1;                ///< in each texel, a square up to 64; see SampleGrid
  std::optional<MatchMethod> match{};       ///< nothing: `facing` if an angle is given, else `closest`
  std::optional<double> facing{};           ///< as of MatchOptions
  std::optional<double> cage{};             ///< the same
  double max_distance = kInfinity;          ///< the same
  std::uint32_t occlusion_rays = 64;        ///< AmbientOcclusionOptions::rays
  double occlusion_distance = kInfinity;    ///< its maximum distance
  ThicknessMethod thickness_method = ThicknessMethod::ball;
  Progress progress{};

  /// The root of `samples`.
  [[nodiscard]] SDM_API std::uint32_t side() const;
};

template <>
inline constexpr auto kOptions<BakeRequest> = std::tuple{
    Option{.name = "channels",
           .member = &BakeRequest::channels,
           .text = "What to bake; by default base_color, and others that the detailed mesh has a texture for "
                   "or that differ between its points. Of its shape: normal, in tangent space of the coarse "
                   "mesh; object_normal; displacement along the smooth normal of the coarse mesh; position; "
                   "ambient_occlusion; thickness, of a closed mesh; the numbers of face and material.",
           .value = "LIST"},
    Option{.name = "resolution",
           .member = &BakeRequest::resolution,
           .text = "Texels along each side of the textures.",
           .range = kResolutionRange,
           .unit = "texels",
           .value = "N"},
    Option{.name = "atlas",
           .member = &BakeRequest::atlas,
           .text =
               "How the coarse mesh is parametrised: by its own UVs, in few charts, or in pairs of "
               "triangles without distortion; by default by its UVs if they lie in [0, 1] and faces do not "
               "overlap there, otherwise in charts."},
    Option{.name = "gutter",
           .member = &BakeRequest::gutter,
           .text = kGutterText,
           .range = kGutterRange,
           .unit = "texels",
           .value = "N"},
    Option{.name = "samples",
           .member = &BakeRequest::samples,
           .text = "Samples in each texel: each has a point of the detailed mesh, and the texel has their "
                   "mean, of numbers that of most of them.",
           .range = {.least = 1, .most = 64, .square = true},
           .value = "N"},
    Option{.name = "match",
           .member = &BakeRequest::match,
           .text =
               "Which point belongs to a texel: the closest one, the closest one that faces the same way, "
               "or the nearest hit along the normal of the coarse mesh that does, where there is one; by "
               "default closest, or facing if that angle is given."},
    facing_option<BakeRequest>({},
                               "Match the closest of the faces of the detailed mesh that face the same "
                               "way: whose normal is within this angle of that of the texel's face. For "
                               "thin walls, where the closest point may be on the other skin."),
    Option{.name = "cage",
           .member = &BakeRequest::cage,
           .text = "How far the match ray searches along the normal, to either side.",
           .range = kPositive,
           .unit = "length",
           .value = "D"},
    max_distance_option<BakeRequest>("Texels farther than this have no match, and are filled from others."),
    Option{.name = "occlusion_rays",
           .member = &BakeRequest::occlusion_rays,
           .text = kOcclusionRaysText,
           .range = kOcclusionRays,
           .value = "N"},
    Option{.name = "occlusion_distance",
           .member = &BakeRequest::occlusion_distance,
           .text = kOcclusionDistanceText,
           .range = kPositiveOrInfinite,
           .unit = "length",
           .value = "D"},
    Option{.name = "thickness_method",
           .member = &BakeRequest::thickness_method,
           .text = "Of thickness: the diameter of the largest ball in the detailed mesh that touches the "
                   "point, or the length of the ray along the inward normal."}};

/// How points are matched. Throws sdm::Error for an angle with `closest`, and for a cage without `ray`.
[[nodiscard]] SDM_API MatchOptions match_options(const BakeRequest& request);
/// The layout of the samples, as of sample_layout(), and its errors. Without an atlas, the kind is that of
/// AtlasOptions.
[[nodiscard]] SDM_API AtlasOptions sample_layout(const BakeRequest& request);
/// What ambient occlusion is asked for.
[[nodiscard]] SDM_API AmbientOcclusionOptions occlusion_options(const BakeRequest& request);

// All matched_…() return values for each texel, in rows as of TexelMatches; texels without a point hold NaN,
// until fill_texels(). They throw sdm::Error if the matches are not from this surface to these sites, or if
// there is not enough memory; Cancelled. Their cost is linear in texels, all cores, unless stated otherwise.

/// Returns the normals of O2 at the matches, of length 1, in the coordinates of the meshes: three numbers a
/// texel. `normals`: at the corners of O2's faces, those of its file or smooth_normals(), which with a crease
/// of 0 are those of faces. Where Sites turns a face of a closed mesh outwards and the normals do not agree
/// with that, they are turned too. `look`: as of GeometryOptions. Also throws if the normals or the look do
/// not fit O2.
[[nodiscard]] SDM_API std::vector<float> matched_normals(const Surface& surface, const Sites& sites,
                                                         const TexelMatches& matches,
                                                         const MeshAttribute& normals,
                                                         const Progress& progress = {},
                                                         const MeshLook* look = nullptr);

/// Returns the matched points of O2: three numbers a texel.
[[nodiscard]] SDM_API std::vector<float> matched_positions(const Surface& surface, const Sites& sites,
                                                           const TexelMatches& matches,
                                                           const Progress& progress = {});

/// Returns how far the matches q are along the normal of O1: (q − p)·n, with p the texel's surface point and
/// n, of length 1, the normal interpolated between the corners of its face. Negative below the surface of O1.
/// Of MatchKind::ray with the same normals, p + displacement · n is the match. Also throws if the normals do
/// not fit O1.
[[nodiscard]] SDM_API std::vector<float> matched_displacements(const Surface& surface, const Sites& sites,
                                                               const TexelMatches& matches,
                                                               const MeshAttribute& normals,
                                                               const Progress& progress = {});

/// Ambient occlusion of texels, estimated by rays.
struct OcclusionEstimate {
  std::vector<float> values;  ///< from 0 to 1; NaN for texels without a point
  /// The standard error of each value, NaN for a single ray: as if eight groups of the directions were
  /// independent, which they are not, as each fills what the others leave free. So errors are mostly
  /// smaller. 0 where the rays of all groups agree.
  std::vector<float> standard_errors;
};

/// Returns, for each matched point of O2, which share of the hemisphere above its face O2 leaves free,
/// weighted by the cosine of the angle to its outward normal, as of ambient_occlusion(). Rays start 1e-6 of
/// the diagonal of O2 above the point; faces nearer than that occlude nothing. Their directions depend on the
/// seed only: each point has one ray along each of options.rays axes, to the outer side of its face. So
/// values are smooth from texel to texel, and rays of neighbouring texels share their searches. Which rays
/// meet O2 is exact. Also throws for options out of range. Cost: options.rays rays a texel.
[[nodiscard]] SDM_API OcclusionEstimate matched_occlusion(const Surface& surface, const Sites& sites,
                                                          const TexelMatches& matches,
                                                          const AmbientOcclusionOptions& options = {});

/// Returns the wall thickness of O2 at the matches, as of ThicknessOptions; NaN where nothing ends it. Also
/// throws unless O2 is closed and orientable. Cost: a ray for each texel; of balls, also a search.
[[nodiscard]] SDM_API std::vector<float> matched_thickness(const Surface& surface, const Sites& sites,
                                                           const TexelMatches& matches,
                                                           ThicknessMethod method,
                                                           const ThicknessOptions& options = {});

/// Returns the materials of the matched faces, or kNone: a number a texel. `face_materials`: for each face of
/// O2 its material, or kNone; none for all if empty. Also throws for another number of faces.
[[nodiscard]] SDM_API std::vector<std::uint32_t> matched_materials(
    const Surface& surface, const Sites& sites, const TexelMatches& matches,
    std::span<const std::uint32_t> face_materials);

/// Returns a channel that is_number() is false for, components_of() numbers a texel. Throws sdm::Error as the
/// function that the channel is named after, and for one of whole numbers.
[[nodiscard]] SDM_API std::vector<float> bake_geometry(const Surface& surface, const Sites& sites,
                                                       const TexelMatches& matches, GeometryChannel channel,
                                                       const GeometryOptions& options = {});

/// Whether this build has tangents(): they need the source of MikkTSpace, which the build fetches.
[[nodiscard]] SDM_API bool has_tangents();

/// Returns the attribute `tangent` of O1 in its atlas, by MikkTSpace (M. S. Mikkelsen), as Blender, Unity,
/// Unreal and glTF's TANGENT have it: four components at each corner of a face, the unit tangent, towards the
/// right of the texture, and w, 1 or −1: the bitangent, towards the upper side of the texture, is w ·
/// cross(normal, tangent). `normals`: at the corners of O1's faces, those that the model is drawn with.
/// Corners have the same row where all four components are equal and the vertex is the same; removed faces
/// have none (kNone). Throws sdm::Error if the normals do not fit, without MikkTSpace, or if there is not
/// enough memory. Cost: O(n log n) in faces, one core.
[[nodiscard]] SDM_API MeshAttribute tangents(const Surface& surface, const MeshAttribute& normals);

/// Returns object-space normals, such as matched_normals(), in the tangent space of O1: three numbers x, y, z
/// a texel, of length 1. With the normal n and the tangent t interpolated between the corners of the texel's
/// face, neither made longer nor shorter, and b = w · cross(n, t), the given normal has the direction of x t
/// + y b + z n, as MikkTSpace demands. `normals` and `tangents` are what the model is drawn with. NaN where
/// the given normal is. Throws sdm::Error if an array does not fit, or if there is not enough memory;
/// Cancelled.
[[nodiscard]] SDM_API std::vector<float> tangent_space_normals(const Surface& surface,
                                                               const MeshAttribute& normals,
                                                               const MeshAttribute& tangents,
                                                               std::span<const float> object_normals,
                                                               const Progress& progress = {});

/// Returns normals, in rows of `resolution` texels, as a picture of `bits`, 8 or 16, a number: (x + 1) / 2
/// and so on, as glTF has it of tangent_space_normals(). Texels without a normal are (0, 0, 1). Throws
/// sdm::Error for another number of bits, and for normals that are no whole rows.
[[nodiscard]] SDM_API Image normal_map_image(std::uint32_t resolution, std::span<const float> normals,
                                             std::uint32_t bits = 8);

/// The same of normals of the texels of a surface.
[[nodiscard]] SDM_API Image normal_map_image(const Surface& surface, std::span<const float> normals,
                                             std::uint32_t bits = 8);

/// Lengths or shares as a picture of one component, and what its numbers stand for.
struct ScalarImage {
  Image image;
  double lower = 0, upper = 1;  ///< of the numbers 0 and 2^bits − 1; between them, values are linear
};

/// Returns values, in rows of `resolution` texels, as a picture of `bits`, 8 or 16, a number; `range`: those
/// of the least and the greatest number. Values that are not finite are the former, others are clamped.
/// Throws sdm::Error for another number of bits, values that are no whole rows, or a range that is empty or
/// not finite.
[[nodiscard]] SDM_API ScalarImage scalar_image(std::uint32_t resolution, std::span<const float> values,
                                               const std::array<double, 2>& range, std::uint32_t bits = 16);

/// Gives the texels of no face values, as TransferOptions::fill does. `values`: `components` numbers for each
/// texel; those of a texel that are not all finite are none. `unmatched`: texels of a face that have none get
/// some, too, as bake() does it; otherwise they stay as they are. Throws sdm::Error for another number of
/// values, or if there is not enough memory.
SDM_API void fill_texels(const Surface& surface, std::size_t components, std::span<float> values,
                         bool unmatched = false);

/// The same for rows of `resolution` texels: all whose values are not finite get some, within `gutter` texels
/// of others, but 4 at least and 16 at most, those of the nearest one.
SDM_API void fill_texels(std::uint32_t resolution, std::size_t components, std::span<float> values,
                         std::uint32_t gutter);

}  // namespace sdm
