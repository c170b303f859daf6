#include "baking/geometry/bent_normals.h"

#include "baking/geometry/mikktspace/frames.h"
#include "geometry/vec.h"

namespace sdm::baking {

NormalTextures::NormalTextures(const Mesh& mesh, const MeshLook& look, const map::CornerNormals& normals)
    : pictures_(look) {
  if (!has_mikktspace()) return;
  look_.emplace(mesh, look, &Material::normal_texture, pictures_);
  std::vector<std::uint32_t> faces;
  std::vector<std::array<MikkCorner, 3>> triangles;
  const Box box = bounds(mesh);
  const Vec3 centre = 0.5 * (box.lower + box.upper);  // single precision resolves what is near it
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    std::array<Vec2, 3> uvs;
    if (is_removed(mesh.triangles[f]) || look_->layer_of(f).picture == nullptr ||
        !look_->layer_of(f).uvs.read(f, uvs))
      continue;
    faces.push_back(f);
    std::array<MikkCorner, 3>& corners = triangles.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = mesh.positions[mesh.triangles[f][k]] - centre, n = normalized(normals.of_corner(f, k));
      for (int c = 0; c < 3; ++c) {
        corners[k].position[c] = static_cast<float>(p[c]);
        corners[k].normal[c] = static_cast<float>(n[c]);
      }
      corners[k].uv = {static_cast<float>(uvs[k][0]), static_cast<float>(uvs[k][1])};
    }
  }
  if (faces.empty()) {
    look_.reset();
    return;
  }
  set_tangents(triangles);
  tangents_.resize(mesh.triangles.size());
  signs_.resize(mesh.triangles.size());
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const auto& [x, y, z, sign] = triangles[i][k].tangent;
      tangents_[faces[i]][k] = {x, y, z};
      signs_[faces[i]][k] = sign < 0 ? -1.f : 1.f;
    }
}

NormalTextures::Reader::Reader(const NormalTextures& textures) : textures_(textures) {
  if (textures.look_) reader_.emplace(*textures.look_);
}

// As glTF has it: with the normal n and the tangent t interpolated, neither made longer nor shorter, and b =
// w cross(n, t), the texture's x, y and z are coordinates of the normal in t, b and n. The material scales x
// and y.
Vec3 NormalTextures::Reader::at(const SurfacePoint& point, const std::array<Vec3, 2>& sides,
                                const Vec3& normal) {
  if (!reader_) return normalized(normal);
  const auto texel = reader_->texel(point, sides);
  if (!texel) return normalized(normal);
  Vec3 t{};
  for (int k = 0; k < 3; ++k) t += point.barycentric[k] * textures_.tangents_[point.face][k];
  const Vec3 b = double{textures_.signs_[point.face][0]} * cross(normal, t);
  const double scale = textures_.look_->layer_of(point.face).material->normal_scale;
  const auto signed_number = [&](int k) { return 2.0 * (*texel)[k] - 1; };
  const Vec3 bent = scale * signed_number(0) * t + scale * signed_number(1) * b + signed_number(2) * normal;
  return squared_norm(bent) > 0 && finite(bent) ? normalized(bent) : normalized(normal);
}

}  // namespace sdm::baking
