// Writes a mesh with more triangles, for bench/whole.
#include <sdm/mesh_files.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "refine_mesh.h"
#include "samples.h"

namespace sdm::bench {
namespace {

struct Refinement {
  std::filesystem::path in, out;
  std::uint32_t parts = 1;
};

void write_refined(const Refinement& options) {
  const auto& [in, out, parts] = options;
  write_mesh(out, refine_mesh(read_mesh(in), parts, 0.1));
}

}  // namespace

void add_refine(CLI::App& program) {
  CLI::App& app =
      *program.add_subcommand("refine", "Writes the mesh with each triangle divided into PARTS² triangles");
  const auto options = std::make_shared<Refinement>();
  app.add_option("IN", options->in)->required();
  app.add_option("OUT", options->out)->required();
  app.add_option("PARTS", options->parts)->required()->check(CLI::Range(1u, 64u));
  app.callback([options] { write_refined(*options); });
}

}  // namespace sdm::bench
