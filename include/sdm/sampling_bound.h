/// Errors between samples: their growth as a surface deforms, and the resolution that a precision requires.
#pragma once

#include <sdm/surface.h>

#include <vector>

namespace sdm {

/// The growth of the largest distance from a surface point to its nearest sample under deformation (Fig. 6 of
/// the paper): with
///
///     r(t) = max over points p of the surface of min over samples s of |p − s|,    e(t) = r(t) / r(0),
///
/// and r_f, e_f the same for the points p of a face f; the nearest sample may lie on any face. Bounded: both
/// are never below the true value, so that e(0) comes out as a little more than 1. As distances are
/// 1-Lipschitz, e is how much the error of a map grows between its samples.
class RelativeError {
 public:
  /// Computes a lower bound on r(0). Throws sdm::Error if there is not enough memory. Cost: some nearest
  /// samples a face, all cores.
  explicit RelativeError(const Surface& first_shape);

  /// sampling_bound() / w ≥ e, where w ≤ r(0) is the distance from the nearest sample that some point of the
  /// first shape had. Here and below `now` must be the same surface after refits; throws sdm::Error when its
  /// number of faces differs.
  [[nodiscard]] double of(const Surface& now) const;

  /// Sets errors[f], one for each face, to face_radii()[f] / w_f ≥ e_f, likewise; infinite where w_f is 0, so
  /// that r_f(0) may be, too. Cost: linear.
  void of_faces(const Surface& now, std::span<double> errors) const;

 private:
  std::vector<double> first_;  ///< w_f
  double largest_;             ///< w
};

/// A resolution at which Surface(mesh, options).sampling_bound() ≤ precision, a length in units of the mesh,
/// whatever options.resolution is; a multiple of 16, because a power of two may need four times the texels.
/// About the smallest: the bound is more than nine tenths of the precision, or a resolution smaller by 16 or
/// an eighth does not suffice. Throws sdm::Error when the precision is not a positive number, when 32768
/// texels a side are not enough for it, and as Surface does. Cost: two to six layouts, as the bound is about
/// proportional to 1 / resolution.
[[nodiscard]] std::uint32_t resolution_for(const Mesh& mesh, AtlasOptions options, double precision);

}  // namespace sdm
