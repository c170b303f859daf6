/// Covering radii of the samples, their growth as a surface deforms, and the resolution that a precision
/// requires.
#pragma once

#include <sdm/api.h>
#include <sdm/surface.h>

#include <memory>
#include <span>
#include <vector>

namespace sdm {
namespace surface {
class PieceAssignment;
}

/// An upper bound on the distance from any point of a surface to its nearest sample.
///
/// Every point p of the surface, on faces without texel or area too, has a sample s_i (see
/// Surface::sample_texels) with |p − s_i| ≤ sample_radii()[i]. As distances are 1-Lipschitz,
///
///     min over i of d_i − r_i  ≤  d(p)  ≤  max over i of d_i + r_i
///
/// for the distances d_i at the samples; p may be any point where d has a value, and d may have signs.
/// Bounded: rounded upwards, never too small.
class SDM_API SamplingBound {
 public:
  /// Cuts the surface into pieces, assigns each to a sample that is near it now, and measures the radii.
  /// Throws sdm::Error if there is not enough memory. Cost: linear in texels and in pieces, about one for
  /// every second texel along edges; all cores.
  explicit SamplingBound(const Surface& surface);
  ~SamplingBound();
  SamplingBound(SamplingBound&&) noexcept;
  SamplingBound& operator=(SamplingBound&&) noexcept;

  /// Measures the radii again after Surface::refit of the same surface. The assignment stays that of the
  /// first shape, which keeps the bound valid, and tight as long as neighbours stay together. Throws
  /// sdm::Error, and changes nothing, when the number of faces or samples differs. Allocates nothing. Cost:
  /// linear in faces, samples and pieces, all cores: far less than the first time.
  void refit(const Surface& surface);

  /// No point of the surface is farther from its nearest sample: the largest radius.
  [[nodiscard]] double value() const;
  /// r_i of each of Surface::sample_texels; 0 where no point needs that sample. Valid until the next refit.
  [[nodiscard]] std::span<const float> sample_radii() const;
  /// For each face a radius within which every one of its points has a sample, which may lie on another face.
  /// Valid until the next refit.
  [[nodiscard]] std::span<const float> face_radii() const;

 private:
  friend const surface::PieceAssignment& internals(const SamplingBound&);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The growth of the largest distance from a surface point to its nearest sample under deformation (Fig. 6 of
/// the paper): with
///
///     r(t) = max over points p of the surface of min over samples s of |p − s|,    e(t) = r(t) / r(0),
///
/// and r_f, e_f the same for the points p of a face f; the nearest sample may lie on any face. Bounded: both
/// are never below the true value, so that e(0) comes out as a little more than 1. As distances are
/// 1-Lipschitz, e is how much the error of a map grows between its samples.
class SDM_API RelativeError {
 public:
  /// Computes a lower bound on r(0) of the surface as it is now, whose bound this is. Throws sdm::Error if
  /// there is not enough memory. Cost: some nearest samples a face, all cores.
  RelativeError(const Surface& first_shape, const SamplingBound& bound);

  /// now.value() / w ≥ e, where w ≤ r(0) is the distance from the nearest sample that some point of the first
  /// shape had. Here and below `now` must be the bound of the same surface after refits; throws sdm::Error
  /// when its number of faces differs.
  [[nodiscard]] double of(const SamplingBound& now) const;

  /// Sets errors[f], one for each face, to now.face_radii()[f] / w_f ≥ e_f, likewise; infinite where w_f is
  /// 0, so that r_f(0) may be, too. Cost: linear.
  void of_faces(const SamplingBound& now, std::span<double> errors) const;

 private:
  std::vector<double> first_;  ///< w_f
  double largest_;             ///< w
};

/// A resolution at which SamplingBound(Surface(mesh, options)).value() ≤ precision, a length in units of the
/// mesh, whatever options.resolution is; a multiple of 16, because a power of two may need four times the
/// texels. About the smallest: the bound is more than nine tenths of the precision, or a resolution smaller
/// by 16 or an eighth does not suffice. Throws sdm::Error when the precision is not a positive number, when
/// 32768 texels a side are not enough for it, and as Surface does. Cost: two to six layouts, as the bound is
/// about proportional to 1 / resolution.
[[nodiscard]] SDM_API std::uint32_t resolution_for(const Mesh& mesh, AtlasOptions options, double precision);

}  // namespace sdm
