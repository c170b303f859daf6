/// Covering radii of the samples, their growth as a surface deforms, and the resolution that a given
/// precision requires.
///
/// Threads: const functions of an object may be called concurrently; nothing else may run beside refit(). The
/// other functions may be called concurrently, also with the same Surface.
#pragma once

#include <sdm/mesh.h>
#include <sdm/options.h>
#include <sdm/surface.h>
#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {
namespace surface {
class PieceAssignment;
}

/// An upper bound on the distance from any point of a surface to its nearest sample.
///
/// Every point p of the surface, including those on faces without texels or area but for removed ones, has a
/// sample s_i (see Surface::sample_texels) with |p − s_i| ≤ sample_radii()[i]. As distances are 1-Lipschitz,
///
///     min over i of d_i − r_i  ≤  d(p)  ≤  max over i of d_i + r_i
///
/// for the distances d_i at the samples and any point p where d has a value; d may be signed. The radii are
/// rounded upwards.
class SDM_API SamplingBound {
 public:
  /// Cuts the surface into pieces, assigns each piece to a nearby sample, and measures the radii. Throws
  /// sdm::Error if there is not enough memory. Cost: linear in texels and pieces (about one piece for every
  /// two texels along edges), all cores.
  explicit SamplingBound(const Surface& surface);
  ~SamplingBound();
  SamplingBound(SamplingBound&&) noexcept;
  SamplingBound& operator=(SamplingBound&&) noexcept;

  /// Measures the radii again after Surface::refit of the same surface. The assignment of pieces to samples
  /// does not change: the bound remains valid, and remains tight as long as neighbouring points stay
  /// together. Throws sdm::Error, and changes nothing, for another surface, and after Surface::edit: a bound
  /// must then be built again. Allocates nothing but tasks; without memory for those, it throws and leaves
  /// the object broken (see sdm/error.h). Cost: linear in faces, samples and pieces, all cores; much less
  /// than construction.
  void refit(const Surface& surface);

  /// The largest radius: no point of the surface is farther from its nearest sample.
  [[nodiscard]] double value() const;
  /// An upper bound on value() after the vertices have moved, each by at most `motion` ≥ 0, without measuring
  /// it: a point and its sample are affine combinations of the corners of a face each, with weights ≥ 0, so
  /// that their distance grows by at most 2·motion. For time steps: the bound that a motion leaves, or the
  /// motion that a bound allows before it must be measured again. Cost: constant.
  [[nodiscard]] double value_after(double motion) const;
  /// r_i of each of Surface::sample_texels; 0 for a sample that no point is assigned to. Valid until the next
  /// refit.
  [[nodiscard]] std::span<const float> sample_radii() const;
  /// A radius for each face, within which every one of its points has a sample, possibly on another face.
  /// Valid until the next refit.
  [[nodiscard]] std::span<const float> face_radii() const;

 private:
  friend const surface::PieceAssignment& internals(const SamplingBound&);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the largest radius of a SamplingBound: no point of the surface is farther from its nearest sample,
/// and |d(p) − d_i| is at most this for a point p and some sample s_i. Equal to
/// SamplingBound(surface).value() up to rounding, at a fraction of the time and memory, as no radii are
/// stored. Throws sdm::Error if there is not enough memory. Cost: linear in texels and faces, all cores.
[[nodiscard]] SDM_API double covering_radius(const Surface& surface);

/// The growth of the largest distance from a surface point to its nearest sample under deformation (Fig. 6 of
/// the paper): with
///
///     r(t) = max over points p of the surface of min over samples s of |p − s|,    e(t) = r(t) / r(0),
///
/// and r_f, e_f likewise for the points p of a face f; the nearest sample may lie on any face. The computed
/// values of e and e_f are upper bounds, so e(0) is slightly above 1. As distances are 1-Lipschitz, e is the
/// factor by which the error of a map between its samples grows.
class SDM_API RelativeError {
 public:
  /// Computes lower bounds on r(0) and r_f(0) from the present shape of the surface; `bound` must be its
  /// bound. Throws sdm::Error if it is not, and if there is not enough memory. Cost: a few nearest-sample
  /// searches per face, all cores.
  RelativeError(const Surface& first_shape, const SamplingBound& bound);

  /// Returns now.value() / w ≥ e, where w ≤ r(0) is the distance from some point of the first shape to its
  /// nearest sample. Here and below `now` must be the bound of the same surface after refits; throws
  /// sdm::Error when its number of faces differs.
  [[nodiscard]] double of(const SamplingBound& now) const;

  /// As of(), also after edits of the surface, or for the bound of another layout of it: the error of the map
  /// now, relative to that of the first shape.
  [[nodiscard]] double of_edited(const SamplingBound& now) const;

  /// Sets errors[f], for each face f, to now.face_radii()[f] / w_f ≥ e_f, likewise; infinite where w_f is 0,
  /// as r_f(0) may then be 0 as well. Cost: linear.
  void of_faces(const SamplingBound& now, std::span<double> errors) const;

 private:
  std::vector<double> first_;  ///< w_f
  double largest_;             ///< w
};

/// Returns a resolution at which covering_radius(Surface(mesh, options)) ≤ precision, a length in units
/// of the mesh; options.resolution is ignored, and options.rows must not be set. The result is a multiple of
/// 16, because a power of two may need four times the texels. It is close to the smallest: either the bound
/// is more than nine tenths of the precision, or a resolution smaller by 16 or by an eighth does not suffice.
/// Throws sdm::Error if the precision is not a positive number, if 32768 texels per side do not suffice, and
/// as Surface does. Cost: two to six atlas layouts, as the bound is about proportional to 1 / resolution.
[[nodiscard]] SDM_API std::uint32_t resolution_for(const Mesh& mesh, double precision,
                                                   const AtlasOptions& options = {});

/// What decides the resolution of an atlas in place of a number.
struct PrecisionOptions {
  std::optional<double> precision{};   ///< as of resolution_for(); > 0, in units of the mesh
  std::optional<double> texel_size{};  ///< a precision of 1/√2 of it; > 0, in units of the mesh
};

inline constexpr std::array kPrecisionExcludes{
    ExcludedOption{"resolution"}, ExcludedOption{"facing", "nothing bounds such distances between samples"},
    ExcludedOption{"along", "nothing bounds such distances between samples"}};
inline constexpr std::array kTexelSizeExcludes{ExcludedOption{"resolution"}, ExcludedOption{"precision"}};

template <>
inline constexpr auto kOptions<PrecisionOptions> = std::tuple{
    Option{.name = "precision",
           .member = &PrecisionOptions::precision,
           .text = "Instead of a resolution: the one at which every point of the surface is within this of a "
                   "sample, so that distances between samples are known as exactly.",
           .range = kPositive,
           .unit = "length",
           .value = "EPS",
           .excludes = kPrecisionExcludes},
    Option{.name = "texel_size",
           .member = &PrecisionOptions::texel_size,
           .text = "Instead of a resolution: the one of texels of about this size on the surface, at which "
                   "every point of it is within 0.71 of that of a sample.",
           .range = kPositive,
           .unit = "length",
           .value = "SIZE",
           .excludes = kTexelSizeExcludes}};

/// Returns the resolution that they ask for; atlas.resolution if they ask for none. Errors and cost as above.
[[nodiscard]] SDM_API std::uint32_t resolution_for(const Mesh& mesh, const PrecisionOptions& options,
                                                   const AtlasOptions& atlas);

}  // namespace sdm
