#include "scenes/letters.h"

#include "io/mesh/formats.h"
#include "scenes/mesh_files.h"

namespace sdm::scenes {

Mesh letter_e() {
  return io::to_mesh(io::read_ply(kLetterEPly.bytes));
}

Mesh letter_g() {
  return io::to_mesh(io::read_ply(kLetterGPly.bytes));
}

}  // namespace sdm::scenes
