// The letters of the paper's experiments.
#pragma once

#include <sdm/mesh.h>

namespace sdm::scenes {

/// The letter E: closed, oriented outwards, 2,098 triangles with edges of about 0.05. It is centred at the
/// origin, 1 high along y and 0.3 deep along z, and readable from +z. meshes/README.md describes how the mesh
/// was made.
[[nodiscard]] Mesh letter_e();

/// The letter G, likewise: 1,600 triangles with edges of about 0.06.
[[nodiscard]] Mesh letter_g();

}  // namespace sdm::scenes
