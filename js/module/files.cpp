// Meshes from the contents of files.
#include <sdm/mesh_files.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "core/checksum.h"
#include "io/mesh/mesh_file.h"
#include "io/mesh/read_polygons.h"
#include "module/given_files.h"
#include "module/result.h"

namespace sdm::js {
namespace {

MeshFile read_file(const FileArguments& arguments) {
  return with_given_files(arguments, [](std::string_view bytes, const std::string& name) {
    MeshFile file = io::to_mesh_file(io::read_polygons(bytes, name), {});
    core::Checksum checksum;
    checksum.add(std::span<const char>(bytes));
    file.xxh3 = core::hex_text(checksum.value());
    return file;
  });
}

}  // namespace

/// The mesh, JSON with what the file says, and the number of the name of each face for each kind of names.
SDM_EXPORT(sdm_read_mesh)
Result* read_mesh_contents(const char* bytes, std::uint32_t size, const char* name, std::uint32_t name_size,
                           const char* names, const char* contents, const std::uint32_t* lengths,
                           std::uint32_t files) {
  return guarded([&](Result& result) {
    MeshFile file = read_file({bytes, size, name, name_size, names, contents, lengths, files});
    nlohmann::ordered_json facts{
        {"names", nlohmann::json::array()}, {"notes", file.notes}, {"xxh3", file.xxh3}};
    file.names.resize(std::min(file.names.size(), Result::kMostArrays - 4));
    for (const FaceNames& kind : file.names)
      facts["names"].push_back({{"kind", kind.kind}, {"names", kind.names}});
    result.put("positions", std::move(file.mesh.positions));
    result.put("indices", std::move(file.mesh.triangles));
    if (!file.mesh.corner_uvs.empty()) result.put("corner_uvs", std::move(file.mesh.corner_uvs));
    result.put_text("facts", facts.dump(-1, ' ', false, nlohmann::json::error_handler_t::ignore));
    for (std::size_t i = 0; i < file.names.size(); ++i)
      result.put("of_faces/" + std::to_string(i), std::move(file.names[i].of_face));
  });
}

}  // namespace sdm::js
