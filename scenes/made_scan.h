/// A made scan of a part: what inspection has to find is known. Bit-identical on every run.
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>

#include <cstddef>

namespace sdm::scenes {

/// Lengths are fractions of the part's size, the diagonal of its bounding box.
struct ScanOptions {
  std::size_t triangles = 80000;  ///< before some are cut away, about
  double noise = 0.0005;          ///< standard deviation of the vertices, along their normals
  double dent = 0.01;             ///< depth
  double tilt = 2;                ///< degrees
  double shift = 0.02;
  double missing = 0.3;  ///< fraction of the area
};

struct MadeScan {
  Mesh mesh{};                                        ///< open; without texture coordinates
  Transform placement{};                              ///< from the part to the scan
  double size = 0;                                    ///< of the part
  Vec3 dent_place{};                                  ///< the middle of the dent, on the surface of the part
  double dent_depth = 0, dent_radius = 0, noise = 0;  ///< lengths
  double missing = 0;                                 ///< fraction of the area
};

/// Refines the part until its triangles are about as large as each other, dents it where it is flat, adds
/// noise, cuts away one end, and tilts and shifts what is left. The dent is (1 − ρ²/r²)² of its depth deep at
/// the distance ρ from its middle, inwards. Throws sdm::Error if there is no flat place, of a radius of three
/// depths, for it. Cost: linear, and 400 candidates for the place.
[[nodiscard]] MadeScan make_scan(const Mesh& part, const ScanOptions& options = {});

}  // namespace sdm::scenes
