// The cpu engine works, and the gl engine says why it does not.
#include <sdm/sdm.h>

#include <cstdio>
#include <string>

namespace {

template <class Call>
bool is_refused(Call call) {
  try {
    call();
    return false;
  } catch (const sdm::Error& error) {
    std::printf("%s\n", error.what());
    return std::string(error.what()).find("built without OpenGL") != std::string::npos;
  }
}

}  // namespace

int main() {
  const sdm::Mesh mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                       .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
                       .corner_uvs = {}};
  const sdm::Surface surface(mesh, {.resolution = 64});
  const sdm::Sites sites(mesh);
  const sdm::DistanceMap map = sdm::compute_map(surface, sites, {.engine = sdm::make_engine("cpu")});
  for (const auto texel : surface.sample_texels())
    if (!(map.distance[texel] < 1e-6)) return 1;
  if (!is_refused([] { (void)sdm::gl_devices(); })) return 2;
  if (!is_refused([] { (void)sdm::make_engine("gl"); })) return 3;
  std::puts("the cpu engine alone works");
  return 0;
}
