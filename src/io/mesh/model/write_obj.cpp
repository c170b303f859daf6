#include "io/mesh/model/write_obj.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <ostream>
#include <set>
#include <string>

#include "io/file/atomic_file.h"
#include "io/mesh/split_vertices.h"

namespace sdm::io {
namespace {

/// Text that is written in blocks.
class BlockText {
 public:
  explicit BlockText(std::ostream& out) : out_(out) {}
  ~BlockText() { flush(); }
  BlockText(const BlockText&) = delete;
  BlockText& operator=(const BlockText&) = delete;

  template <class... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
    constexpr std::size_t kBlock = std::size_t{1} << 16;
    if (text_.size() > kBlock) flush();
  }

 private:
  void flush() {
    out_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
    text_.clear();
  }

  std::ostream& out_;
  fmt::memory_buffer text_;
};

// Blanks are read as one, and lines end names.
std::string word_of(std::string name) {
  std::ranges::replace_if(
      name, [](unsigned char c) { return c < ' '; }, ' ');
  return name.empty() ? "unnamed" : name;
}

/// The names of materials in a library, each once.
std::vector<std::string> library_names(std::span<const Material> materials) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Material& material : materials) {
    std::string name = word_of(material.name);
    for (int i = 2; !taken.insert(name).second; ++i) name = fmt::format("{} {}", word_of(material.name), i);
    names.push_back(std::move(name));
  }
  return names;
}

std::string picture_name(const std::filesystem::path& library, std::size_t texture, const TextureFile& file) {
  return fmt::format("{}_{}.{}", library.stem().string(), texture, picture_format(file.bytes));
}

void write_use(BlockText& text, const char* statement, const TextureUse& use, const std::string& picture) {
  text.add("{}", statement);
  if (use.wrap[0] == TextureWrap::clamp && use.wrap[1] == TextureWrap::clamp) text.add(" -clamp on");
  const auto& [s, t] = use.place;
  if (s[0] != 1 || t[1] != 1) text.add(" -s {} {} 1", s[0], t[1]);
  if (s[2] != 0 || t[2] != 0) text.add(" -o {} {} 0", s[2], t[2]);
  text.add(" {}\n", picture);
}

void write_library(const std::filesystem::path& file, const MeshExtras& extras) {
  AtomicFile out(file);
  {
    BlockText text(out.stream());
    const std::vector<std::string> names = library_names(extras.materials);
    const auto use = [&](const char* statement, const TextureUse& texture) {
      if (texture.texture < extras.textures.size())
        write_use(text, statement, texture,
                  picture_name(file, texture.texture, extras.textures[texture.texture]));
    };
    for (std::size_t i = 0; i < names.size(); ++i) {
      const Material& m = extras.materials[i];
      text.add("newmtl {}\nKd {} {} {}\nd {}\nPm {}\nPr {}\n", names[i], in_srgb(m.base_color[0]),
               in_srgb(m.base_color[1]), in_srgb(m.base_color[2]),
               m.alpha_mode == AlphaMode::opaque ? 1 : m.base_color[3], m.metallic, m.roughness);
      if (m.emissive != std::array<float, 3>{})
        text.add("Ke {} {} {}\n", in_srgb(m.emissive[0]), in_srgb(m.emissive[1]), in_srgb(m.emissive[2]));
      use("map_Kd", m.base_color_texture);
      use("map_Ke", m.emissive_texture);
      use("norm", m.normal_texture);
    }
  }
  out.commit();
  for (std::size_t i = 0; i < extras.textures.size(); ++i) {
    AtomicFile picture(file.parent_path() / picture_name(file, i, extras.textures[i]));
    const std::vector<char>& bytes = extras.textures[i].bytes;
    picture.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    picture.commit();
  }
}

const FaceNames* names_of_kind(std::span<const FaceNames> names, std::string_view kind) {
  const auto found = std::ranges::find(names, kind, &FaceNames::kind);
  return found == names.end() ? nullptr : &*found;
}

/// A statement before the faces of a name.
class NameStatement {
 public:
  NameStatement(const char* statement, const std::vector<std::string>& names,
                std::span<const std::uint32_t> of_face, const char* without)
      : statement_(statement), without_(without), names_(names), of_face_(of_face) {}

  void before(std::size_t face, BlockText& text) {
    if (of_face_.empty() || (of_face_[face] == last_ && face > 0)) return;
    last_ = of_face_[face];
    if (last_ != kNone)
      text.add("{} {}\n", statement_, names_[last_]);
    else if (face > 0)
      text.add("{} {}\n", statement_, without_);
  }

 private:
  const char *statement_, *without_;
  const std::vector<std::string>& names_;
  std::span<const std::uint32_t> of_face_;
  std::uint32_t last_ = kNone;
};

void write_faces(std::ostream& out, const Mesh& mesh, const MeshExtras& extras, const std::string& library) {
  const UvRows uvs = uv_rows(mesh);
  const MeshAttribute* const normals = find_attribute(extras.attributes, "normal", 3, 3);
  const MeshAttribute* const colors = find_attribute(extras.attributes, "color", 3, 4);
  std::vector<CornerRows> of_vertices;
  if (colors != nullptr) of_vertices.push_back({colors->rows.get()});
  const SplitVertices split = split_vertices(mesh, of_vertices);
  BlockText text(out);
  if (!library.empty()) text.add("mtllib {}\n", library);
  for (std::size_t i = 0; i < split.vertex.size(); ++i) {
    const Vec3& p = mesh.positions[split.vertex[i]];
    text.add("v {} {} {}", p[0], p[1], p[2]);
    if (colors != nullptr) {
      const std::uint32_t row = split.rows[0][i];
      for (std::size_t k = 0; k < 3; ++k)
        text.add(" {}", row == kNone ? 1 : in_srgb(colors->values[colors->components * row + k]));
    }
    text.add("\n");
  }
  for (const Vec2& uv : uvs.uvs) text.add("vt {} {}\n", uv[0], uv[1]);
  for (std::size_t i = 0; normals != nullptr && i < normals->values.size(); i += 3)
    text.add("vn {} {} {}\n", normals->values[i], normals->values[i + 1], normals->values[i + 2]);
  std::vector<NameStatement> statements;
  const auto state = [&](const char* statement, const char* kind, const char* without) {
    if (const FaceNames* const names = names_of_kind(extras.names, kind))
      statements.emplace_back(statement, names->names, names->of_face, without);
  };
  state("o", "object", "");
  state("g", "group", "");
  const std::vector<std::string> names = library_names(extras.materials);
  if (!extras.materials.empty())
    statements.emplace_back("usemtl", names, extras.face_materials, "none");
  else
    state("usemtl", "material", "none");
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (NameStatement& statement : statements) statement.before(f, text);
    text.add("f");
    for (int k = 0; k < 3; ++k) {
      text.add(" {}", std::size_t{1} + split.triangles[f][k]);
      const std::uint32_t normal = normals == nullptr ? kNone : (*normals->rows)[f][k];
      if (!uvs.of.empty()) text.add("/{}", std::size_t{1} + uvs.of[f][k]);
      if (normal != kNone) text.add("{}{}", uvs.of.empty() ? "//" : "/", std::size_t{1} + normal);
    }
    text.add("\n");
  }
}

}  // namespace

void write_obj(const std::filesystem::path& file, const Mesh& mesh, const MeshExtras& extras) {
  std::string library = extras.library;
  if (library.empty() && !extras.materials.empty()) {
    const std::filesystem::path beside = std::filesystem::path(file).replace_extension(".mtl");
    write_library(beside, extras);
    library = beside.filename().string();
  }
  AtomicFile out(file);
  write_faces(out.stream(), mesh, extras, library);
  out.commit();
}

}  // namespace sdm::io
