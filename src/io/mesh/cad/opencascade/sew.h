// Faces that meet along edges of their own.
#pragma once

#include "io/mesh/cad/opencascade/document.h"

namespace sdm::io::cad {

/// Gives faces of IGES that meet edge to edge these edges in common, where OpenCASCADE can: trimmed surfaces
/// have none in common. Nothing changes where each edge has two faces.
void sew(Document& document);

}  // namespace sdm::io::cad
