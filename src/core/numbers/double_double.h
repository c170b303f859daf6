// Numbers of twice the digits of a double, for predicates that rounding could change.
#pragma once

#include <cmath>

namespace sdm::core {

/// high + low, where low is at most half a unit in the last place of high. NaN where a step overflows.
struct DoubleDouble {
  double high = 0, low = 0;
};

/// a + b, exactly (Knuth 1969).
inline DoubleDouble exact_sum(double a, double b) {
  const double sum = a + b, of_b = sum - a;
  return {sum, (a - (sum - of_b)) + (b - of_b)};
}

/// a · b, exactly unless it underflows.
inline DoubleDouble exact_product(double a, double b) {
  const double product = a * b;
#ifdef FP_FAST_FMA
  return {product, std::fma(a, b, -product)};
#else
  // Dekker 1971: halves of 26 digits, whose products are exact.
  const auto upper_half = [](double x) {
    const double scaled = 134217729 * x;  // 2²⁷ + 1
    return scaled - (scaled - x);
  };
  const double a1 = upper_half(a), a2 = a - a1, b1 = upper_half(b), b2 = b - b1;
  return {product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
#endif
}

/// The relative error of a sum or a difference is less than 4 · 2⁻¹⁰⁶, that of a product less than 8 · 2⁻¹⁰⁶,
/// beside what underflows (Joldes, Muller and Popescu, Tight and Rigorous Error Bounds for Basic Building
/// Blocks of Double-Word Arithmetic, 2017).
inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble high = exact_sum(a.high, b.high), low = exact_sum(a.low, b.low);
  const DoubleDouble sum = exact_sum(high.high, high.low + low.high);
  return exact_sum(sum.high, sum.low + low.low);
}
inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) {
  return a + DoubleDouble{-b.high, -b.low};
}
inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble product = exact_product(a.high, b.high);
  return exact_sum(product.high, product.low + (a.high * b.low + a.low * b.high));
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
