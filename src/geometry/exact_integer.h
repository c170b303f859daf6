// Coordinates as integers, for exact predicates.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

namespace sdm::core {

// Differences of coordinates as integers, in a unit that divides all of them. For any two doubles they have
// at most 2100 bits, and a product of three has three times as many. The size is fixed: nothing is allocated.
using boost::multiprecision::cpp_int_backend;
using Integer =
    boost::multiprecision::number<cpp_int_backend<6400, 6400, boost::multiprecision::signed_magnitude,
                                                  boost::multiprecision::unchecked, void>>;

inline int exponent_of(double x) {  // x is a multiple of 2 to this power
  constexpr int kDigits = std::numeric_limits<double>::digits;
  int exponent = 0;
  std::frexp(x, &exponent);
  return exponent - kDigits;
}

inline Integer in_units(double x, int exponent) {
  const int own = exponent_of(x);
  return x == 0 ? Integer(0) : Integer(static_cast<std::int64_t>(std::ldexp(x, -own))) << (own - exponent);
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
