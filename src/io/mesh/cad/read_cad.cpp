// STEP and IGES, by the module that has OpenCASCADE.
#include <fmt/format.h>
#include <sdm/closest_points.h>
#include <sdm/error.h>
#include <sdm/sites.h>

#include <memory>
#include <span>

#include "io/file/input_files.h"
#include "io/mesh/cad/read_in_child.h"
#include "io/mesh/formats.h"

namespace sdm::io {
namespace {

using cad::CadFormat;
using cad::CadShape;

constexpr std::size_t kIgesSection = 72;  // the column of the section's letter

PolygonMesh to_polygons(const CadShape& shape) {
  PolygonMesh mesh;
  mesh.positions = shape.positions;
  mesh.corners.reserve(3 * shape.triangles.size());
  mesh.ends.reserve(shape.triangles.size());
  for (const auto& triangle : shape.triangles) {
    mesh.corners.insert(mesh.corners.end(), triangle.begin(), triangle.end());
    mesh.end_polygon();
  }
  for (std::size_t i = 0; i < shape.faces.size(); ++i) {
    const CadShape::Face& face = shape.faces[i];
    mesh.objects.begin(face.first_triangle, shape.objects[face.object]);
    mesh.faces.begin(face.first_triangle, face.name.empty() ? fmt::format("face {}", i + 1) : face.name);
    mesh.colors.begin(face.first_triangle, face.color);
  }
  return mesh;
}

/// Measures distances to the triangles.
class Client final : public cad::CadClient {
 public:
  void tessellated(const CadShape& shape) override {
    sites_ = std::make_unique<Sites>(to_mesh(to_polygons(shape)));
  }

  double distance(const Vec3& point) override {
    return closest_points(*sites_, std::span(&point, 1)).front().distance;
  }

 private:
  std::unique_ptr<Sites> sites_;
};

// OpenCASCADE reads what is there of a file that was cut.
void require_end(std::string_view bytes, bool there) {
  if (!there)
    throw Error(fmt::format("has {} bytes and no end; the file is truncated or damaged", bytes.size()));
}

bool has_iges_end(std::string_view bytes) {
  const std::size_t last = bytes.find_last_not_of(" \t\r\n\0\x1a");
  if (last == std::string_view::npos) return false;
  const std::size_t begin = bytes.substr(0, last).find_last_of("\r\n") + 1;
  return last - begin >= kIgesSection && bytes[begin + kIgesSection] == 'T';
}

PolygonMesh read(std::string_view bytes, const std::filesystem::path& file, CadFormat format,
                 const TessellationOptions& options) {
  const char* const name = format == CadFormat::step ? "STEP" : "IGES";
  constexpr double kAny = kInfinity;
  check_options(options);
  if (!(options.at_most.value_or(1) > 0)) throw Error("the largest deflection must be greater than 0");
  Client client;
  const CadShape shape = cad::read_in_child({.bytes = bytes,
                                             .file = file.c_str(),
                                             .format = format,
                                             .deflection = options.deflection.value_or(0),
                                             .at_most = options.at_most.value_or(kAny),
                                             .most_triangles = options.most_triangles,
                                             .angle = options.angle},
                                            name, client);
  for (const std::string& part : shape.parts) note_input(part);
  PolygonMesh mesh = to_polygons(shape);
  mesh.tessellation =
      Tessellation{.format = name,
                   .file_unit = shape.unit,
                   .faces = shape.faces.size(),
                   .omitted_faces = shape.omitted_faces,
                   .deflection = shape.deflection,
                   .angle = options.angle,
                   .limited = !options.deflection && shape.deflection > options.at_most.value_or(kAny),
                   .largest_deviation = shape.largest_deviation,
                   .measured_points = shape.measured_points};
  if (shape.omitted_faces > 0)
    mesh.notes.push_back(fmt::format("{} of {} faces could not be tessellated and are missing",
                                     shape.omitted_faces, mesh.tessellation->faces));
  if (!shape.has_labels)
    mesh.notes.emplace_back(
        "OpenCASCADE fails on the names of its parts, or on its colours: both are left out");
  if (!shape.documents.empty())
    mesh.notes.push_back("it refers to files that are not read, as no shape is missing without them: " +
                         first_of(shape.documents));
  return mesh;
}

}  // namespace

bool reads_cad() {
  return true;
}

PolygonMesh read_step(std::string_view bytes, const std::filesystem::path& file,
                      const TessellationOptions& options) {
  if (!is_step(bytes)) throw Error("does not begin with ISO-10303-21; it is not STEP");
  require_end(bytes, bytes.rfind("END-ISO-10303-21") != std::string_view::npos);
  return read(bytes, file, CadFormat::step, options);
}

PolygonMesh read_iges(std::string_view bytes, const std::filesystem::path& file,
                      const TessellationOptions& options) {
  if (!is_iges(bytes))
    throw Error("has no start section of IGES as text; compressed and binary IGES are not read");
  require_end(bytes, has_iges_end(bytes));
  return read(bytes, file, CadFormat::iges, options);
}

}  // namespace sdm::io
