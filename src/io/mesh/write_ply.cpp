#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <new>
#include <string>

#include "core/memory.h"
#include "io/file/atomic_file.h"
#include "io/file/little_endian.h"

namespace sdm {

using namespace io;

void write_ply(const std::filesystem::path& file, const Mesh& mesh) try {
  AtomicFile out(file);
  out.stream() << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.positions.size()
               << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
               << mesh.triangles.size() << "\nproperty list uchar uint vertex_indices\n"
               << (mesh.corner_uvs.empty() ? "" : "property list uchar double texcoord\n") << "end_header\n";
  std::string bytes;
  for (const Vec3& p : mesh.positions)
    for (const double x : p) append_little_endian(bytes, x);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    bytes.push_back(3);
    for (const std::uint32_t v : mesh.triangles[f]) append_little_endian(bytes, v);
    if (mesh.corner_uvs.empty()) continue;
    bytes.push_back(6);
    for (const Vec2& uv : mesh.corner_uvs[f])
      for (const double x : uv) append_little_endian(bytes, x);
  }
  out.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
