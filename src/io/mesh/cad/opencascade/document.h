// A CAD file as OpenCASCADE reads it: parts with their places, names and colours.
#pragma once

#include <TDocStd_Document.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "io/mesh/cad/cad_module.h"

namespace sdm::io::cad {

/// A face of an instance of a part, in the coordinates of the file.
struct PlacedFace {
  TopoDS_Face face;
  std::string name, color;
  std::uint32_t object;
};

/// All faces of a file, in its order.
struct Document {
  std::vector<PlacedFace> faces;
  std::vector<std::string> objects;  ///< each name once
  TopoDS_Shape whole;
  std::string unit;
  std::vector<std::string> parts;      ///< files that the file refers to
  std::vector<std::string> documents;  ///< those that are not read, and that no shape is missing without
};

/// Throws std::runtime_error with a clause, or Standard_Failure.
[[nodiscard]] Document read_document(const CadRequest& request);

}  // namespace sdm::io::cad
