// The spacing of samples on deforming faces: measured, and as the paper bounds it.
#pragma once

#include <sdm/surface.h>

namespace sdm::figures {

/// The largest distance from points of the faces to their nearest samples, by comparing all of them:
/// `divisions` points along the sides of each face, corners included. A lower bound on the covering radius.
/// Cost: the product of both numbers.
[[nodiscard]] double measured_gap(const Surface& surface, int divisions);

/// The covering radius of the lattice of a face's samples, if it had no border: |a||b||a − b| / (2 |a × b|)
/// of its reduced basis.
[[nodiscard]] double lattice_radius(const Surface& surface, std::uint32_t face);

/// The largest distance between four adjacent samples of a face: the longer diagonal of its texels.
[[nodiscard]] double adjacent_distance(const Surface& surface, std::uint32_t face);

/// The paper's bound f(δ) on that distance, after scales s and a shear s_h of a rectangle of width b (5.1).
[[nodiscard]] double paper_bound(double spacing, double width, double scale, double shear);

/// A rectangle of `columns` × `rows` texels of side `spacing`, in the plane z = 0, with a texel's centre in
/// the middle of each square; of two triangles.
[[nodiscard]] Mesh rectangle(int columns, int rows, double spacing);
/// It as a surface whose atlas has those texels.
[[nodiscard]] Surface rectangle_surface(int columns, int rows, double spacing);

}  // namespace sdm::figures
