#include "baking/look_reader.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace sdm::baking {
namespace {

const Material kPlain{};

const MeshAttribute* attribute_of(const MeshLook& look, const std::string& name, std::size_t least,
                                  std::size_t most) {
  const auto found = std::ranges::find(look.attributes, name, &MeshAttribute::name);
  if (found == look.attributes.end() || !found->rows) return nullptr;
  return found->components >= least && found->components <= most ? &*found : nullptr;
}

std::size_t components_of(BakeChannel channel, const MeshLook& look) {
  const auto used = used_materials(look);
  switch (channel) {
    case BakeChannel::base_color:
      return std::ranges::any_of(used, [](const Material* m) { return m->alpha_mode != AlphaMode::opaque; })
                 ? 4
                 : 3;
    case BakeChannel::metallic_roughness:
      return 2;
    case BakeChannel::occlusion:
      return 1;
    case BakeChannel::emissive:
      break;
  }
  return 3;
}

// The derivatives of the weights of corners 1 and 2 by points of the plane of a face; 0 for one without area.
std::array<Vec3, 2> weight_derivatives(const Mesh& mesh, std::uint32_t face) {
  const Triangle& t = mesh.triangles[face];
  const Vec3 a = mesh.positions[t[1]] - mesh.positions[t[0]], b = mesh.positions[t[2]] - mesh.positions[t[0]];
  const double aa = dot(a, a), bb = dot(b, b), ab = dot(a, b), determinant = aa * bb - ab * ab;
  if (!(determinant > 0)) return {};
  return {(1 / determinant) * (bb * a - ab * b), (1 / determinant) * (aa * b - ab * a)};
}

template <class Value>
Value interpolated(const std::array<Value, 3>& corners, const Vec3& weights) {
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

}  // namespace

TextureUse Material::*texture_of(BakeChannel channel) {
  switch (channel) {
    case BakeChannel::base_color:
      break;
    case BakeChannel::metallic_roughness:
      return &Material::metallic_roughness_texture;
    case BakeChannel::occlusion:
      return &Material::occlusion_texture;
    case BakeChannel::emissive:
      return &Material::emissive_texture;
  }
  return &Material::base_color_texture;
}

const MipChain* Pictures::prepare(const TextureUse& use, bool srgb) {
  if (use.texture == kNone || look_.pictures[use.texture].width == 0) return nullptr;
  std::unique_ptr<MipChain>& chain = chains_[{use.texture, srgb}];
  if (!chain) chain = std::make_unique<MipChain>(look_.pictures[use.texture], srgb);
  return chain.get();
}

bool UvSet::read(std::uint32_t face, std::array<Vec2, 3>& uvs) const {
  if (mesh != nullptr) {
    uvs = mesh->corner_uvs[face];
    return true;
  }
  if (attribute == nullptr) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t row = (*attribute->rows)[face][k];
    if (row == kNone) return false;
    for (std::size_t i = 0; i < 2; ++i) uvs[k][i] = attribute->values[2 * std::size_t{row} + i];
    if (!std::isfinite(uvs[k][0]) || !std::isfinite(uvs[k][1])) return false;
  }
  return true;
}

ChannelLook::ChannelLook(const Mesh& m, const MeshLook& l, BakeChannel c, Pictures& pictures)
    : mesh(m), look(l), channel(c), components(components_of(c, l)) {
  add_layers(texture_of(channel), is_color(channel), pictures);
  if (channel == BakeChannel::base_color) vertex_colors = attribute_of(look, "color", 3, 4);
}

ChannelLook::ChannelLook(const Mesh& m, const MeshLook& l, TextureUse Material::*texture, Pictures& pictures)
    : mesh(m), look(l), channel(BakeChannel::base_color), components(0) {
  add_layers(texture, false, pictures);
}

void ChannelLook::add_layers(TextureUse Material::*texture, bool srgb, Pictures& pictures) {
  const auto add = [&](const Material& material) {
    Layer& layer = layers.emplace_back(&material, nullptr, material.*texture);
    layer.picture = pictures.prepare(layer.use, srgb);
    if (layer.picture == nullptr) return;
    if (layer.use.uv_set > 0 || mesh.corner_uvs.empty())
      layer.uvs.attribute = attribute_of(look, "uv" + std::to_string(layer.use.uv_set), 2, 2);
    else
      layer.uvs.mesh = &mesh;
  };
  const auto used = used_materials(look);
  auto next = used.begin();  // in the order of the materials
  for (const Material& material : look.materials)
    if (next != used.end() && *next == &material) {
      add(material);
      ++next;
    } else
      layers.push_back({&material, nullptr, {}, {}});
  add(kPlain);
}

void LookReader::read_face(std::uint32_t face) {
  face_ = face;
  layer_ = &look_->layer_of(face);
  std::array<Vec2, 3> uvs;
  textured_ = layer_->picture != nullptr && layer_->uvs.read(face, uvs);
  if (!textured_) return;
  const auto& [s, t] = layer_->use.place;
  const double width = layer_->picture->width(), height = layer_->picture->height();
  for (std::size_t k = 0; k < 3; ++k)
    pixels_[k] = {(s[0] * uvs[k][0] + s[1] * uvs[k][1] + s[2]) * width,
                  (1 - t[0] * uvs[k][0] - t[1] * uvs[k][1] - t[2]) * height};
  constexpr double kMost = 1e15;  // where pixels are still told apart
  for (const Vec2& pixel : pixels_)
    if (!(std::abs(pixel[0]) < kMost && std::abs(pixel[1]) < kMost)) textured_ = false;
  const auto weights = weight_derivatives(look_->mesh, face);
  for (std::size_t i = 0; i < 2; ++i)
    derivatives_[i] =
        (pixels_[1][i] - pixels_[0][i]) * weights[0] + (pixels_[2][i] - pixels_[0][i]) * weights[1];
}

std::array<float, 4> LookReader::texture(const SurfacePoint& point, const std::array<Vec3, 2>& sides) const {
  MipChain::Place place{
      .centre = interpolated(pixels_, point.barycentric), .sides = {}, .wrap = layer_->use.wrap};
  for (std::size_t k = 0; k < 2; ++k)
    place.sides[k] = {dot(derivatives_[0], sides[k]), dot(derivatives_[1], sides[k])};
  return layer_->picture->mean(place);
}

std::array<float, 4> LookReader::vertex_color(const SurfacePoint& point) const {
  std::array<float, 4> color{1, 1, 1, 1};
  const MeshAttribute* const attribute = look_->vertex_colors;
  if (attribute == nullptr) return color;
  const Triangle& rows = (*attribute->rows)[point.face];
  if (std::ranges::count(rows, kNone) > 0) return color;
  for (std::size_t k = 0; k < attribute->components; ++k) {
    double sum = 0;
    for (std::size_t corner = 0; corner < 3; ++corner)
      sum += point.barycentric[corner] * attribute->values[rows[corner] * attribute->components + k];
    color[k] = std::isfinite(sum) ? static_cast<float>(sum) : 1.f;
  }
  return color;
}

std::optional<std::array<float, 4>> LookReader::texel(const SurfacePoint& point,
                                                      const std::array<Vec3, 2>& sides) {
  if (point.face != face_) read_face(point.face);
  if (!textured_) return std::nullopt;
  return texture(point, sides);
}

void LookReader::at(const SurfacePoint& point, const std::array<Vec3, 2>& sides, float* values) {
  if (point.face != face_) read_face(point.face);
  const std::array<float, 4> texel = textured_ ? texture(point, sides) : std::array<float, 4>{1, 1, 1, 1};
  const Material& m = *layer_->material;
  switch (look_->channel) {
    case BakeChannel::base_color: {
      const std::array<float, 4> color = vertex_color(point);
      for (std::size_t k = 0; k < look_->components; ++k) values[k] = m.base_color[k] * texel[k] * color[k];
      if (look_->components == 4 && m.alpha_mode == AlphaMode::opaque) values[3] = 1;
      break;
    }
    case BakeChannel::metallic_roughness:
      values[0] = m.roughness * texel[1];
      values[1] = m.metallic * texel[2];
      break;
    case BakeChannel::occlusion:
      values[0] = 1 + m.occlusion_strength * (texel[0] - 1);
      break;
    case BakeChannel::emissive:
      for (std::size_t k = 0; k < 3; ++k) values[k] = m.emissive[k] * texel[k];
  }
}

void require_materials(const MeshLook& look) {
  for (const std::uint32_t material : look.face_materials)
    if (material != kNone && material >= look.materials.size())
      throw Error("a face refers to material " + std::to_string(material) + " of " +
                  std::to_string(look.materials.size()));
}

void require_fitting(const Mesh& mesh, const MeshLook& look) {
  const std::size_t faces = mesh.triangles.size();
  if (!look.face_materials.empty() && look.face_materials.size() != faces)
    throw Error("a mesh of " + std::to_string(faces) + " faces needs as many numbers of materials, not " +
                std::to_string(look.face_materials.size()));
  require_materials(look);
  const auto require_picture = [&](const TextureUse& use) {
    if (use.texture != kNone && use.texture >= look.pictures.size())
      throw Error("a material refers to picture " + std::to_string(use.texture) + " of " +
                  std::to_string(look.pictures.size()));
  };
  for (const Material& material : look.materials) {
    for (const BakeChannel channel : kBakeChannels) require_picture(material.*texture_of(channel));
    require_picture(material.normal_texture);
  }
  for (const Image& picture : look.pictures)
    if (const std::size_t bytes =
            std::size_t{picture.width} * picture.height * picture.components * (picture.bits == 16 ? 2 : 1);
        picture.bytes.size() != bytes || (picture.bits != 8 && picture.bits != 16) ||
        picture.components > 4 || (bytes == 0 && picture.width > 0))
      throw Error("the bytes of a picture are not those of its pixels");
  for (const MeshAttribute& attribute : look.attributes) {
    if (!attribute.rows) continue;
    const std::size_t count = attribute.values.size() / std::max<std::size_t>(1, attribute.components);
    if (attribute.rows->size() != faces || std::ranges::any_of(*attribute.rows, [&](const Triangle& rows) {
          return std::ranges::any_of(rows, [&](std::uint32_t row) { return row != kNone && row >= count; });
        }))
      throw Error("the attribute `" + attribute.name + "` belongs to another mesh");
  }
}

std::vector<const Material*> used_materials(const MeshLook& look) {
  std::vector<std::uint8_t> used(look.materials.size() + 1);
  for (const std::uint32_t material : look.face_materials)
    used[material == kNone ? look.materials.size() : material] = 1;
  if (look.face_materials.empty()) used.back() = 1;
  std::vector<const Material*> materials;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i] != 0) materials.push_back(i < look.materials.size() ? &look.materials[i] : &kPlain);
  return materials;
}

}  // namespace sdm::baking
