// The mesh of a command that measures one mesh by itself.
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "map_files.h"
#include "report.h"

/// The options on its file.
struct PartFile {
  std::string file, transform;
  std::optional<sdm::WeldOptions> weld{};
  sdm::TessellationOptions tessellation{};
};

struct LoadedPart {
  Input input;
  double import_ms = 0;
};

/// Reads the mesh, places it, welds it as asked for and inspects it. `vertices`: keeps those of the file, for
/// files of values at vertices. Throws sdm::Error as load_input() and weld() do.
[[nodiscard]] LoadedPart load_part(const PartFile& part, bool vertices);

/// The files that such a command writes in any case.
[[nodiscard]] std::vector<std::filesystem::path> planned_files(const MapFiles& files);
