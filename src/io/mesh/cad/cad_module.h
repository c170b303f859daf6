// What the readers of meshes and the module libsdm_cad.so exchange. The module, which is loaded by the
// process that reads a CAD file, alone sees and links OpenCASCADE: its 60 shared libraries would delay the
// start of every command.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sdm::io::cad {

enum class CadFormat : std::uint8_t { step, iges };

struct CadRequest {
  std::string_view bytes;
  const char* file;  ///< which holds the bytes
  CadFormat format;
  double deflection;  ///< 0: kDefaultDeflection of the diagonal
  double at_most;     ///< then, unless there would be more than `most_triangles`; infinite: without a limit
  std::size_t most_triangles;
  double angle;
  bool labels = true;  ///< whether names of parts, and colours, are read
};

inline constexpr double kDefaultDeflection = 1.0 / 2000;

/// Triangles over shared vertices: faces that share an edge share its vertices.
struct CadShape {
  struct Face {
    std::string name, color;  ///< "#rrggbb"; empty if it has none
    std::uint32_t object = 0;
    std::size_t first_triangle = 0;  ///< up to that of the next face
  };

  std::string fault;          ///< a clause; empty unless the file could not be read
  bool is_exception = false;  ///< the fault is one of OpenCASCADE's own
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Face> faces;
  std::vector<std::string> objects;  ///< the instances of parts
  std::string unit;
  std::vector<std::string> parts;      ///< the files that it refers to, which were read too
  std::vector<std::string> documents;  ///< those that were not, and that no shape is missing without
  bool has_labels = true;              ///< else they could not be read
  double deflection = 0;
  std::size_t omitted_faces = 0;
  std::size_t measured_points = 0;
  double largest_deviation = 0;
};

/// The side of the readers.
class CadClient {
 public:
  virtual ~CadClient() = default;
  /// Called once, before distance().
  virtual void tessellated(const CadShape& shape) = 0;
  /// The distance from a point to the triangles.
  virtual double distance(const Vec3& point) = 0;
};

/// Reads and tessellates a file, measures how far its surfaces are from the triangles, and sets `shape`. Not
/// by two threads at a time. Uses the calling thread only, and does not throw.
using ReadCad = void(const CadRequest& request, CadShape& shape, CadClient& client);

// The names by which the module is found; both are of type extern "C".
inline constexpr const char* kModuleFile = "libsdm_cad.so";
inline constexpr const char* kVersionSymbol = "sdm_cad_version";  ///< const char*() of sdm::kVersion
inline constexpr const char* kReadSymbol = "sdm_cad_read";        ///< a ReadCad

}  // namespace sdm::io::cad
