#include <sdm/io.h>
#include <sdm/sdm.h>

#include <cstdio>

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::puts("usage: first_map O1 O2");
    return 2;
  }
  const sdm::Surface surface(sdm::read_mesh(argv[1]));            // O1, laid out in a texture
  const sdm::Sites sites(sdm::read_mesh(argv[2]));                // O2
  const sdm::DistanceMap map = sdm::compute_map(surface, sites);  // distance, vector, closest site
  const sdm::SamplingBound bound(surface);                        // covering radii of the samples
  const sdm::DistanceStatistics d = sdm::statistics(surface, map);
  std::printf("distance %g to %g, mean %g, error bound %g\n", d.min, d.max, d.mean, bound.value());
  sdm::write_exr("map.exr", surface, map);
} catch (const sdm::Error& error) {
  std::puts(error.what());
  return 1;
}
