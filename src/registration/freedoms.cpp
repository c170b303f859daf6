#include "registration/freedoms.h"

#include <sdm/align.h>

#include <cmath>

#include "registration/point_to_plane.h"

namespace sdm::registration {
namespace {

struct OrderedMotions {
  Matrix6 motions;  ///< as columns, by decreasing determination
  int allowed = 6;  ///< the number of allowed ones, which come first
  int free = 0;     ///< the number of free ones, which are the last of these
};

int free_count(const Motion& squared_decreasing, int allowed) {
  int free = 0;
  for (int k = 0; k < allowed; ++k) free += std::sqrt(std::max(0.0, squared_decreasing[k])) < kFree;
  return free;
}

OrderedMotions ordered_motions(const Matrix6& information, const Motions& allowed) {
  const auto count = static_cast<int>(allowed.cols());
  OrderedMotions result{.motions = Matrix6::Identity(), .allowed = count};
  if (count == 6) {
    const Spectrum<6> all = spectrum(information);
    result.motions = all.vectors.rowwise().reverse();
    result.free = free_count(all.values.reverse(), count);
    return result;
  }
  // No eigenvalue of an information is negative: those of the rest of the matrix come first.
  const Spectrum<6> inside = spectrum(reduced(information, allowed, -1));
  const Matrix6 decreasing = inside.vectors.rowwise().reverse();
  result.motions.leftCols(count) = allowed * decreasing.topLeftCorner(count, count);
  result.free = free_count(inside.values.reverse(), count);
  // The others are orthogonal to them: the eigenvectors of the projection with an eigenvalue of 0.
  result.motions.rightCols(6 - count) =
      spectrum(Matrix6(allowed * allowed.transpose())).vectors.leftCols(6 - count);
  return result;
}

// Rotates a basis of free motions so that as many of them as possible are pure translations: with the
// rotation parts W, those are the eigenvectors of WᵀW with an eigenvalue of zero. The others are orthogonal
// to them, which makes the screws of a cylinder or a plane rotations about their axes. W is a part of
// orthonormal columns, so that its eigenvalues are at most 1: the rest of the matrix comes last.
Motions separated(const Motions& free) {
  Matrix6 turns = Matrix6::Zero();
  turns.topLeftCorner<3, 3>().setIdentity();
  return free * spectrum(reduced(turns, free, 2)).vectors.topLeftCorner(free.cols(), free.cols());
}

// The axis of the screw with the rotation ω and the translation τ at the centre is where ω × x + τ is along
// ω.
DegreeOfFreedom described(const Motion& motion, const Pivot& pivot) {
  DegreeOfFreedom result;
  result.rotation = vec3(motion.head<3>());
  result.translation = vec3(motion.tail<3>());
  const double squared = squared_norm(result.rotation);
  if (squared > 1e-12)
    result.axis_point = pivot.centre + (pivot.radius / squared) * cross(result.rotation, result.translation);
  return result;
}

}  // namespace

Motions determined_motions(const Correspondences& pairs, const Sites& o2, const Pivot& pivot, double cut,
                           const Motions& allowed) {
  const OrderedMotions all =
      ordered_motions(information(pairs, smooth_normals(pairs, o2), pivot, cut), allowed);
  return all.motions.leftCols(all.allowed - all.free);
}

std::array<DegreeOfFreedom, 6> degrees_of_freedom(const Correspondences& pairs, const Sites& o2,
                                                  const Pivot& pivot, double cut, double deviation,
                                                  std::size_t count, const Motions& allowed) {
  const Matrix6 matrix = information(pairs, smooth_normals(pairs, o2), pivot, cut);
  OrderedMotions all = ordered_motions(matrix, allowed);
  const int first_free = all.allowed - all.free;
  if (all.free > 0)
    all.motions.middleCols(first_free, all.free) = separated(all.motions.middleCols(first_free, all.free));
  std::array<DegreeOfFreedom, 6> result;
  for (int k = 0; k < 6; ++k) {
    const Motion motion = all.motions.col(k);
    result[k] = described(motion, pivot);
    result[k].determined = std::sqrt(std::max(0.0, motion.dot(matrix * motion)));
    result[k].locked = k >= all.allowed;
    result[k].free = k >= first_free && !result[k].locked;
    if (k < first_free)
      result[k].standard_error = deviation / (result[k].determined * std::sqrt(static_cast<double>(count)));
  }
  return result;
}

}  // namespace sdm::registration

namespace sdm {

namespace {

constexpr std::string_view kAxes = "xyz";

}  // namespace

std::optional<AlignFreedoms> parse_freedoms(std::string_view text) {
  AlignFreedoms result{.translations = {}, .rotations = {}};
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',');
    std::string_view word = text.substr(0, comma);
    more = comma != std::string_view::npos;
    if (more) text.remove_prefix(comma + 1);
    const bool turns = word.starts_with('r');
    if (turns) word.remove_prefix(1);
    if (word.empty()) return std::nullopt;
    for (const char letter : word) {
      const std::size_t axis = kAxes.find(letter);
      if (axis == std::string_view::npos) return std::nullopt;
      (turns ? result.rotations : result.translations)[axis] = true;
    }
  }
  return result;
}

std::vector<std::string> names_of(const AlignFreedoms& freedoms) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < 3; ++k)
    if (freedoms.translations[k]) names.emplace_back(1, kAxes[k]);
  for (std::size_t k = 0; k < 3; ++k)
    if (freedoms.rotations[k]) names.push_back(std::string("r") + kAxes[k]);
  return names;
}

bool OptionForm<AlignFreedoms>::read(std::string_view text, const OptionRange&, AlignFreedoms& value) {
  std::optional<AlignFreedoms> freedoms = parse_freedoms(text);
  if (!freedoms) return false;
  freedoms->about = value.about;
  value = *freedoms;
  return true;
}

std::string OptionForm<AlignFreedoms>::text(const AlignFreedoms& value) {
  return OptionForm<std::vector<std::string>>::text(names_of(value));
}

}  // namespace sdm
