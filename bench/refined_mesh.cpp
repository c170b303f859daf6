// Writes a mesh with more triangles, for bench/whole.
#include <sdm/mesh_files.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>

#include "refine_mesh.h"

int main(int argc, char** argv) try {
  CLI::App app("Writes the mesh as PLY with each triangle divided into PARTS² triangles");
  std::filesystem::path in, out;
  std::uint32_t parts = 1;
  app.add_option("IN", in)->required();
  app.add_option("OUT", out)->required();
  app.add_option("PARTS", parts)->required()->check(CLI::Range(1u, 64u));
  CLI11_PARSE(app, argc, argv);
  sdm::write_ply(out, sdm::bench::refine_mesh(sdm::read_mesh(in), parts, 0.1));
} catch (const std::exception& error) {
  std::fprintf(stderr, "refined_mesh: %s\n", error.what());
  return 1;
}
