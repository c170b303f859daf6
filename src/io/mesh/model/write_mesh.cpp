#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <new>
#include <string>

#include "core/memory.h"
#include "io/file/atomic_file.h"
#include "io/file/little_endian.h"
#include "io/mesh/model/mesh_model.h"
#include "io/mesh/model/write_obj.h"
#include "io/mesh/write_ply.h"

namespace sdm {

using namespace io;

namespace {

void write_stl(std::ostream& out, const Mesh& mesh, const MeshExtras& /*extras*/) {
  std::string bytes(80, ' ');
  append_little_endian(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    for (const Vec3& p : {normalized(cross(b - a, c - a)), a, b, c})
      for (const double x : p) append_little_endian(bytes, static_cast<float>(x));
    bytes.append(2, '\0');
  }
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

using Writer = void (*)(std::ostream& out, const Mesh& mesh, const MeshExtras& extras);
struct WrittenFormat {
  const char* extension;
  Writer write;  ///< null: write_obj(), which writes several files
  bool single_precision;
};
constexpr WrittenFormat kFormats[] = {{".ply", io::write_ply, false},
                                      {".obj", nullptr, false},
                                      {".stl", write_stl, true},
                                      {".glb", write_model, true}};

const WrittenFormat& written_format(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const WrittenFormat& format : kFormats)
    if (extension == format.extension) return format;
  throw Error(file.string() + ": the extension of a mesh to write must be .ply, .obj, .stl or .glb");
}

/// Throws sdm::Error unless the mesh is valid, and what is written belongs to its faces.
void require_fitting(const Mesh& mesh, const MeshExtras& extras) {
  validate(mesh);
  const std::size_t faces = mesh.triangles.size();
  bool fits = extras.face_materials.empty() || extras.face_materials.size() == faces;
  for (const std::uint32_t material : extras.face_materials)
    fits &= material == kNone || material < extras.materials.size();
  for (const FaceNames& names : extras.names) {
    fits &= names.of_face.size() == faces;
    for (const std::uint32_t name : names.of_face) fits &= name == kNone || name < names.names.size();
  }
  for (const MeshAttribute& attribute : extras.attributes) {
    fits &= attribute.components > 0 && attribute.rows && attribute.rows->size() == faces;
    if (!fits) break;
    const std::size_t rows = attribute.values.size() / attribute.components;
    for (const Triangle& t : *attribute.rows)
      for (const std::uint32_t row : t) fits &= row == kNone || row < rows;
  }
  if (!fits)
    throw Error("the attributes, materials and names to write do not belong to the faces of the mesh");
}

}  // namespace

bool is_written_in_single_precision(const std::filesystem::path& file) {
  return written_format(file).single_precision;
}

void write_mesh(const std::filesystem::path& file, const Mesh& mesh, const MeshExtras& extras) try {
  const WrittenFormat& format = written_format(file);
  require_fitting(mesh, extras);
  if (format.write == nullptr) return write_obj(file, mesh, extras);
  AtomicFile out(file);
  format.write(out.stream(), mesh, extras);
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
