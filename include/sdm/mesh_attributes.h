/// What meshes have besides their geometry: attributes at the corners of faces (normals, colours, numbers of
/// any name), materials with pictures, texture coordinates outside of the unit square (textures that repeat,
/// UDIM tiles), names of faces.
///
/// Threads: plain values; the functions may be called concurrently, also with the same mesh.
#pragma once

#include <sdm/mesh.h>
#include <sdm/names.h>
#include <sdm/types.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sdm {

/// An array of a file, as rows of numbers that corners of faces refer to. Values may jump between the faces
/// around a vertex, where the file has several rows for it.
struct MeshAttribute {
  /// `normal`, three components, as the file has them, moved as the faces are; `color`, three or four
  /// components from 0 to 1, in linear light; `uv1`, `uv2`, ...: further sets of texture coordinates; `uv0`:
  /// those of Mesh::corner_uvs, which is empty then, where only some corners have them; others as in the
  /// file. `face_color`, `face_...`: of faces, where vertices have an array of that name.
  std::string name;
  std::size_t components = 1;
  std::vector<float> values;  ///< row after row
  /// The rows of the corners of each triangle of the mesh; kNone: the file has none. Arrays that the file
  /// has for its vertices share them.
  std::shared_ptr<const std::vector<Triangle>> rows;
};

/// Returns the attribute `normal` of a mesh whose file has none: at each vertex, the mean of the normals of
/// its faces, weighted by their angles there, of length 1. Faces that differ by more than `crease` degrees
/// from the first one of a vertex do not share its normal; from 180 on, all do. Normals point to the side
/// from which the corners of faces are counter-clockwise; faces without area take those of others, or (0, 0,
/// 1). Throws sdm::Error for a negative angle, or if there is not enough memory. Cost: linear.
[[nodiscard]] SDM_API MeshAttribute smooth_normals(const Mesh& mesh, double crease = 180);

/// The crease of the normals that models are drawn with.
inline constexpr double kDrawnCrease = 40;

/// What a texture has outside of [0, 1].
enum class TextureWrap : std::uint8_t {
  repeat,  ///< copies of it
  mirror,  ///< copies of it, every other one mirrored
  clamp,   ///< its border
};

/// A texture on faces.
struct TextureUse {
  std::uint32_t texture = kNone;  ///< of MeshFile::textures; kNone: there is none
  std::uint32_t uv_set = 0;       ///< 0: Mesh::corner_uvs; n: the attribute `uv<n>`
  /// The affine map, by rows, from texture coordinates to places in the texture: (0, 0) at its lower left,
  /// (1, 1) at its upper right.
  std::array<std::array<double, 3>, 2> place{{{1, 0, 0}, {0, 1, 0}}};
  std::array<TextureWrap, 2> wrap{};  ///< along u and v

  friend bool operator==(const TextureUse&, const TextureUse&) = default;
};

/// What the alpha of a base colour means.
enum class AlphaMode : std::uint8_t {
  opaque,  ///< nothing
  mask,    ///< below alpha_cutoff there is no surface
  blend,   ///< the share of its light; the rest is what is behind
};

template <>
inline constexpr std::array kWords<AlphaMode>{"opaque", "mask", "blend"};

/// A surface as glTF describes it (metallic-roughness), which textures multiply. Numbers are from 0 to 1, of
/// light linear.
struct Material {
  std::string name;
  std::array<float, 4> base_color{1, 1, 1, 1};  ///< red, green, blue, alpha
  std::array<float, 3> emissive{};
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  float metallic = 0, roughness = 1;
  float normal_scale = 1;                 ///< of x and y of normal_texture
  float occlusion_strength = 1;           ///< 0: occlusion_texture has no effect
  TextureUse base_color_texture;          ///< sRGB, and alpha
  TextureUse metallic_roughness_texture;  ///< roughness in green, metallic in blue
  TextureUse normal_texture;              ///< of tangent space, (1 + x) / 2
  TextureUse occlusion_texture;           ///< in red
  TextureUse emissive_texture;            ///< sRGB
};

/// A picture that materials refer to, as it is stored: decode_image() reads it.
struct TextureFile {
  std::string name;         ///< of its file, or of the picture in the file of the mesh
  std::vector<char> bytes;  ///< PNG, JPEG or WebP
};

/// Pixels, row after row from the top, of grey, grey and alpha, red, green and blue, or these and alpha.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::uint32_t components = 0;  ///< 1 to 4
  std::uint32_t bits = 8;        ///< of a number, 8 or 16
  /// Each number in one byte, or in two with the lower one first.
  std::vector<std::uint8_t> bytes;

  /// A number, from 0 to 1 as the file has it: colours usually in sRGB.
  [[nodiscard]] float value(std::uint32_t x, std::uint32_t y, std::uint32_t component) const {
    const std::size_t i = (std::size_t{y} * width + x) * components + component;
    if (bits == 8) return static_cast<float>(bytes[i]) / 255.f;
    return static_cast<float>(bytes[2 * i] | bytes[2 * i + 1] << 8) / 65535.f;
  }
};

/// The intensity in linear light of a colour component in sRGB (IEC 61966-2-1), both from 0 to 1.
[[nodiscard]] inline float linear_light(float srgb) {
  if (srgb <= 0.04045f) return srgb / 12.92f;
  return std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

/// A unit square [u, u + 1] × [v, v + 1] of the texture plane, and the faces in it.
struct UvTile {
  std::int32_t u = 0, v = 0;
  std::vector<std::uint32_t> faces;

  /// Whether it has a UDIM number: 0 ≤ u ≤ 9 and v ≥ 0.
  [[nodiscard]] bool has_udim() const { return u >= 0 && u <= 9 && v >= 0 && v < 900; }
  /// The UDIM number, from 1001.
  [[nodiscard]] int udim() const { return 1001 + u + 10 * v; }
};

/// The tiles of a mesh.
struct UvTiles {
  std::vector<UvTile> tiles;            ///< with a face each; by v, then u
  std::vector<std::uint32_t> crossing;  ///< faces in more than one tile, which `tiles` does not contain

  /// Several tiles with UDIM numbers, and no face in more than one: each is a texture of its own.
  [[nodiscard]] bool is_udim() const;
  /// All faces are in the tile [0, 1]².
  [[nodiscard]] bool is_unit_square() const;
};

/// Faces belong to a tile if their corners are in it but for 1e-6. Throws sdm::Error if the mesh has no
/// texture coordinates, or coordinates beyond 1e6. Cost: linear.
[[nodiscard]] SDM_API UvTiles uv_tiles(const Mesh& mesh);
/// Whether the texture coordinates of all corners are the same, as programs write them that have no others.
/// Not if there are none. Cost: linear.
[[nodiscard]] SDM_API bool has_one_uv(const Mesh& mesh);

/// The faces of a tile, with texture coordinates relative to it. Vertices keep their numbers.
[[nodiscard]] SDM_API Mesh uv_tile_mesh(const Mesh& mesh, const UvTile& tile);

/// A mesh whose faces are in the unit square.
struct WrappedUvs {
  /// The faces of the mesh in their order, then the further pieces of faces that were cut; vertices that were
  /// added by cuts come last.
  Mesh mesh;
  std::vector<std::uint32_t> source_face;  ///< of each face, that of the original mesh
  std::size_t cut_faces = 0;               ///< of the original mesh
};

/// Moves all faces into the unit square, as a texture that repeats shows them. Faces in more than one tile
/// are cut along the borders: pieces of texture area below 1e-14 are omitted. Throws sdm::Error as uv_tiles()
/// does, and if the tiles in the boxes of these faces are more than 2^16 and 16 for each face of the mesh;
/// the message names the face with most of them. Cost: linear, and in the pieces.
[[nodiscard]] SDM_API WrappedUvs wrap_uvs(const Mesh& mesh, const UvTiles& tiles);

/// Names that a file gives to faces: those of objects (OBJ o, glTF meshes, solids of STL text, 3DS), of
/// groups (OBJ g; several of one face, as in "g a b", are one name) or of materials (OBJ usemtl, glTF). CAD
/// has objects, the instances of its parts, faces, "face 7" for the seventh if it has no name, and colors,
/// such as "#c0ffee".
struct FaceNames {
  std::string kind;                    ///< "object", "group", "material", "face" or "color"
  std::vector<std::string> names;      ///< each once, in the order of the file
  std::vector<std::uint32_t> of_face;  ///< for each triangle of the mesh, an index into names or kNone
};

/// The faces that have a name.
struct NamedFaces {
  std::string kind;                  ///< as FaceNames::kind
  std::vector<std::uint32_t> faces;  ///< ascending
};

/// Returns the faces with a name: those of the first kind of which a face has it. None if no face has the
/// name, as where all of them were left out. Cost: linear in faces.
[[nodiscard]] SDM_API NamedFaces faces_named(std::span<const FaceNames> names, const std::string& name);

/// Returns the names of the faces of a part of a mesh. `source_face`: of each face of the part, that of the
/// mesh; empty: the part is the mesh. Cost: linear in faces and kinds of names.
[[nodiscard]] SDM_API std::vector<FaceNames> names_of_part(std::span<const FaceNames> names,
                                                           std::span<const std::uint32_t> source_face);

/// Returns the kinds and names of all faces as a clause for messages: "its names are a, b, ..." with the
/// first 20 of them, or "its faces have no names". Cost: linear in names.
[[nodiscard]] SDM_API std::string names_text(std::span<const FaceNames> names);

/// Returns, for each face, the number of its component: the faces that are connected by shared vertices.
/// Components are numbered from 0 in the order of their first faces; removed faces (see MeshEdit) have kNone.
/// Cost: linear.
[[nodiscard]] SDM_API std::vector<std::uint32_t> face_components(const Mesh& mesh);

}  // namespace sdm
