// Triangles of the faces of a document, joined along its edges.
#pragma once

#include "io/mesh/cad/opencascade/document.h"

namespace sdm::io::cad {

/// Sets all of `shape` but what measure() does. `deflection` must be positive.
void tessellate(const Document& document, double deflection, double angle, CadShape& shape);

/// Measures how far the exact surfaces are from the triangles.
void measure(const Document& document, CadShape& shape, CadClient& client);

}  // namespace sdm::io::cad
