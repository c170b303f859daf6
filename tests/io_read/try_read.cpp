#include "io_read/try_read.h"

#include <sdm/error.h>
#include <sdm/mesh.h>
#include <sdm/sequence.h>

#include <fstream>
#include <stdexcept>
#include <string>

namespace sdm::test {
namespace {

void require(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error(what);
}

// The mesh that frames of positions alone belong to.
std::string rest_mesh(const std::filesystem::path& folder) {
  std::string file = (folder / "rest.off").string();
  if (!std::filesystem::exists(file))
    std::ofstream(file) << "OFF 4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  return file;
}

}  // namespace

bool try_read(const std::filesystem::path& file) {
  const bool positions_alone = file.extension() == ".npy";
  try {
    MeshSequence sequence(positions_alone ? rest_mesh(file.parent_path()) + "+" + file.string()
                                          : file.string());
    try {
      validate(sequence.mesh());
    } catch (const Error& fault) {
      throw std::logic_error("not a valid mesh: " + std::string(fault.what()));
    }
    for (std::size_t frame = 0; frame < sequence.frame_count(); ++frame)
      require(sequence.positions(frame).size() == sequence.mesh().positions.size(), "frames of unequal size");
    return true;
  } catch (const Error& fault) {
    const std::string message = fault.what();
    require(!message.empty() && message.find('\n') == std::string::npos,
            "an error not of one line: " + message);
    return false;
  }
}

}  // namespace sdm::test
