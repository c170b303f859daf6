/// How the faces of a mesh are laid out in a texture atlas.
///
/// Threads: plain data, without state.
#pragma once

#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/progress.h>

#include <array>
#include <cstdint>
#include <optional>
#include <tuple>

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

}  // namespace sdm
