#include "search/mixed_bound.h"

#include <algorithm>
#include <optional>

namespace sdm::search {
namespace {

// A few suffice to exchange three constraints; more are due to rounding.
constexpr int kMostSteps = 16;
constexpr double kWeightRounding = 1e-12;  // of weights, and of values relative to the bound

double largest(const CornerValues& values) {
  return std::max({values[0], values[1], values[2]});
}

// The dual simplex method for: the largest t that is at most the value of each function at the point with the
// weights x₀, x₁ and x₂ = 1 − x₀ − x₁. Of the constraints, three are active.
class LargestValue {
 public:
  LargestValue(std::span<const CornerValues> functions, const CornerValues& first) : functions_(functions) {
    // Two weights are 0 at the largest corner.
    const int at = first[0] >= first[1] && first[0] >= first[2] ? 0 : first[1] >= first[2] ? 1 : 2;
    int zero = 1;
    for (int k = 0; k < 3; ++k)
      if (k != at) active_[zero++] = {.weight = k};
    active_[0] = {.function = &first};
    // The rows of the inverse are the changes of x₀, x₁ and t.
    const Row rows[3] = {row(active_[0]), row(active_[1]), row(active_[2])};
    // rows[1] and rows[2] have no t: their inverse, then that of the first.
    const double determinant = rows[1][0] * rows[2][1] - rows[1][1] * rows[2][0];
    const double a = rows[2][1] / determinant, b = -rows[1][1] / determinant, c = -rows[2][0] / determinant,
                 d = rows[1][0] / determinant;
    inverse_[0] = {0, 0, 1};
    inverse_[1] = {a, c, -(rows[0][0] * a + rows[0][1] * c)};
    inverse_[2] = {b, d, -(rows[0][0] * b + rows[0][1] * d)};
  }

  // Improves the bound until it is at most `enough`.
  void solve(double enough) {
    for (int step = 0; step < kMostSteps; ++step) {
      find_point();
      if (t_ <= enough || !enter()) return;
    }
    find_point();
  }

  // The mean of the functions by the weights of their constraints.
  [[nodiscard]] std::optional<double> bound() const {
    CornerValues mean{};
    double sum = 0;
    for (int n = 0; n < 3; ++n) {
      if (active_[n].function == nullptr) continue;
      const double weight = std::max(0.0, inverse_[n][2]);
      sum += weight;
      for (int k = 0; k < 3; ++k) mean[k] += weight * (*active_[n].function)[k];
    }
    if (!(sum > 0.5)) return {};
    return largest(mean) / sum;
  }
  // The weights of the point, with sum 1. Those whose constraints are active are 0, without rounding.
  [[nodiscard]] CornerValues weights() const {
    CornerValues weights;
    for (int k = 0; k < 3; ++k) weights[k] = std::max(0.0, weights_[k]);
    for (const Constraint& c : active_)
      if (c.function == nullptr) weights[c.weight] = 0;
    const double sum = weights[0] + weights[1] + weights[2];
    for (double& weight : weights) weight /= sum;
    return weights;
  }
  [[nodiscard]] std::array<std::uint32_t, 3> mixed() const {
    std::array<std::uint32_t, 3> mixed{kNone, kNone, kNone};
    for (int n = 0; n < 3; ++n)
      if (active_[n].function != nullptr && inverse_[n][2] > kWeightRounding)
        mixed[n] = static_cast<std::uint32_t>(active_[n].function - functions_.data());
    return mixed;
  }

 private:
  using Row = std::array<double, 3>;
  // The value of a function is at least t, or a weight is at least 0.
  struct Constraint {
    const CornerValues* function = nullptr;
    int weight = 0;
  };

  // A constraint is row·(x₀, x₁, t) ≤ limit.
  static Row row(const Constraint& c) {
    if (c.function != nullptr) {
      const auto& [f0, f1, f2] = *c.function;
      return {f2 - f0, f2 - f1, 1};
    }
    return c.weight == 0 ? Row{-1, 0, 0} : c.weight == 1 ? Row{0, -1, 0} : Row{1, 1, 0};
  }
  static double limit(const Constraint& c) {
    return c.function != nullptr ? (*c.function)[2] : c.weight == 2 ? 1 : 0;
  }

  void find_point() {
    double x[3] = {};
    for (int n = 0; n < 3; ++n)
      for (int k = 0; k < 3; ++k) x[k] += limit(active_[n]) * inverse_[n][k];
    weights_ = {x[0], x[1], 1 - x[0] - x[1]};
    t_ = x[2];
  }

  // Replaces an active constraint by one that the point violates. Returns false if it violates none.
  bool enter() {
    Constraint entering;
    double least = -kWeightRounding;
    for (int k = 0; k < 3; ++k)
      if (weights_[k] < least) {
        least = weights_[k];
        entering = {.weight = k};
      }
    if (least == -kWeightRounding) {
      double lowest = t_ - kWeightRounding * t_;
      for (const CornerValues& f : functions_) {
        const double value = weights_[0] * f[0] + weights_[1] * f[1] + weights_[2] * f[2];
        if (value < lowest) {
          lowest = value;
          entering = {.function = &f};
        }
      }
      if (entering.function == nullptr) return false;
    }
    const Row entered = row(entering);
    double share[3];
    int leaving = -1;
    double ratio = kInfinity;
    for (int n = 0; n < 3; ++n) {
      const Row& column = inverse_[n];
      share[n] = entered[0] * column[0] + entered[1] * column[1] + entered[2] * column[2];
      if (share[n] > kWeightRounding && column[2] < ratio * share[n]) {
        ratio = column[2] / share[n];
        leaving = n;
      }
    }
    if (leaving < 0) return false;
    Row& left = inverse_[leaving];
    for (double& x : left) x /= share[leaving];
    for (int n = 0; n < 3; ++n)
      if (n != leaving)
        for (int k = 0; k < 3; ++k) inverse_[n][k] -= share[n] * left[k];
    active_[leaving] = entering;
    return true;
  }

  std::span<const CornerValues> functions_;
  Constraint active_[3];
  Row inverse_[3];  // of the matrix of their rows, by column
  CornerValues weights_{};
  double t_ = 0;
};

}  // namespace

MixedBound mixed_bound(std::span<const CornerValues> functions, double enough) {
  MixedBound result;
  const CornerValues* first = nullptr;
  for (const CornerValues& values : functions)
    if (const double most = largest(values); most < result.value) {
      result.value = most;
      first = &values;
    }
  if (first == nullptr || result.value <= enough) return result;
  LargestValue program(functions, *first);
  program.solve(enough);
  result.value = std::min(result.value, program.bound().value_or(result.value));
  result.weights = program.weights();
  result.mixed = program.mixed();
  return result;
}

}  // namespace sdm::search
