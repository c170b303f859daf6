#include "look.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace sdm::python {
namespace {

using Colors = nb::ndarray<const float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using CornerUvs = nb::ndarray<const double, nb::shape<-1, 3, 2>, nb::c_contig, nb::device::cpu>;
using Pixels = nb::ndarray<const std::uint8_t, nb::ndim<3>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<const std::uint32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// The rows of corners of an array over the vertices, faces or corners of a mesh.
std::vector<Triangle> rows_of(const Mesh& mesh, std::string_view domain) {
  if (domain == "vertex") return mesh.triangles;
  std::vector<Triangle> rows(mesh.triangles.size());
  for (std::uint32_t f = 0; f < rows.size(); ++f)
    rows[f] = domain == "face" ? Triangle{f, f, f} : Triangle{3 * f, 3 * f + 1, 3 * f + 2};
  return rows;
}

/// Adds colours in sRGB, with alpha if they have four components.
void add_colors(const Colors& colors, const std::string& domain, MeshFile& file) {
  const std::size_t count = domain == "vertex" ? file.mesh.positions.size()
                            : domain == "face" ? file.mesh.triangles.size()
                                               : 3 * file.mesh.triangles.size();
  if (colors.shape(0) != count)
    throw Error(domain + "_colors needs a row for each of " + std::to_string(count) + " " +
                (domain == "vertex" ? "vertices" : domain + "s") + ", not " +
                std::to_string(colors.shape(0)));
  MeshAttribute color{.name = "color", .components = colors.shape(1), .values = {}, .rows = nullptr};
  color.values.assign(colors.data(), colors.data() + colors.size());
  for (std::size_t i = 0; i < color.values.size(); ++i)
    if (i % color.components < 3) color.values[i] = linear_light(color.values[i]);
  color.rows = std::make_shared<const std::vector<Triangle>>(rows_of(file.mesh, domain));
  file.attributes.push_back(std::move(color));
}

/// NaN where a corner has none.
void add_uvs(const CornerUvs& uvs, MeshFile& file) {
  const std::size_t faces = file.mesh.triangles.size();
  if (uvs.shape(0) != faces)
    throw Error("uvs needs a row for each of " + std::to_string(faces) + " faces, not " +
                std::to_string(uvs.shape(0)));
  file.mesh.corner_uvs.clear();
  if (std::all_of(uvs.data(), uvs.data() + uvs.size(), [](double x) { return std::isfinite(x); })) {
    file.mesh.corner_uvs.resize(faces);
    for (std::size_t i = 0; i < uvs.size(); ++i)
      file.mesh.corner_uvs[i / 6][i / 2 % 3][i % 2] = uvs.data()[i];
    return;
  }
  MeshAttribute partial{.name = "uv0", .components = 2, .values = {}, .rows = nullptr};
  std::transform(uvs.data(), uvs.data() + uvs.size(), std::back_inserter(partial.values),
                 [](double x) { return static_cast<float>(x); });
  partial.rows = std::make_shared<const std::vector<Triangle>>(rows_of(file.mesh, "corner"));
  file.attributes.push_back(std::move(partial));
}

Image picture_of(nb::handle pixels) {
  const auto given = nb::cast<Pixels>(pixels);
  if (given.size() == 0 || given.shape(2) > 4)
    throw Error("texture must have the shape (height, width, 1 to 4) and at least one pixel");
  return {.width = static_cast<std::uint32_t>(given.shape(1)),
          .height = static_cast<std::uint32_t>(given.shape(0)),
          .components = static_cast<std::uint32_t>(given.shape(2)),
          .bits = 8,
          .bytes = {given.data(), given.data() + given.size()}};
}

AlphaMode alpha_mode_of(std::string_view name) {
  if (name == "MASK") return AlphaMode::mask;
  return name == "BLEND" ? AlphaMode::blend : AlphaMode::opaque;
}

Material material_of(const nb::dict& from) {
  Material material;
  material.base_color = nb::cast<std::array<float, 4>>(from["base_color"]);
  material.emissive = nb::cast<std::array<float, 3>>(from["emissive"]);
  material.alpha_mode = alpha_mode_of(nb::cast<std::string>(from["alpha_mode"]));
  material.alpha_cutoff = nb::cast<float>(from["alpha_cutoff"]);
  material.metallic = nb::cast<float>(from["metallic"]);
  material.roughness = nb::cast<float>(from["roughness"]);
  if (from.contains("diffuse")) {
    const auto srgb = nb::cast<std::array<float, 3>>(from["diffuse"]);
    std::ranges::transform(srgb, material.base_color.begin(), linear_light);
  }
  const auto texture = [&](const char* name) {
    return from.contains(name) ? nb::cast<std::uint32_t>(from[name]) : kNone;
  };
  material.base_color_texture.texture = texture("base_color_texture");
  material.metallic_roughness_texture.texture = texture("metallic_roughness_texture");
  material.occlusion_texture.texture = texture("occlusion_texture");
  material.emissive_texture.texture = texture("emissive_texture");
  return material;
}

}  // namespace

void add_look(const nb::dict& from, Look& look) {
  if (from.contains("uvs")) add_uvs(nb::cast<CornerUvs>(from["uvs"]), look.file);
  if (from.contains("colors"))
    add_colors(nb::cast<Colors>(from["colors"]), nb::cast<std::string>(from["domain"]), look.file);
  for (const nb::handle material : nb::cast<nb::list>(from["materials"]))
    look.file.materials.push_back(material_of(nb::cast<nb::dict>(material)));
  for (const nb::handle picture : nb::cast<nb::list>(from["pictures"]))
    look.pictures.push_back(picture_of(picture));
  if (from.contains("face_materials")) {
    const auto given = nb::cast<Numbers>(from["face_materials"]);
    look.file.face_materials.assign(given.data(), given.data() + given.size());
  } else if (!look.file.materials.empty()) {
    look.file.face_materials.assign(look.file.mesh.triangles.size(), 0);
  }
  const bool has_uvs = !look.file.mesh.corner_uvs.empty() || from.contains("uvs");
  if (!look.pictures.empty() && !has_uvs) throw Error("texture needs a mesh with texture coordinates");
}

}  // namespace sdm::python
