// What std::to_chars(double) calls for integers of 2^53 and more. That of libc++ also takes a precision, for
// which it has tables of 105 kB.
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "include/ryu/d2fixed.h"

_LIBCPP_BEGIN_NAMESPACE_STD

/// All digits of an integer of at least 2^53; the precision is 0.
to_chars_result __d2fixed_buffered_n(char* first, char* const last, const double integer, const uint32_t) {
  constexpr uint32_t kBase = 1'000'000'000, kDigits = 9, kMostLimbs = 35;  // of 309 digits
  int exponent = 0;
  const auto mantissa = static_cast<uint64_t>(std::ldexp(std::frexp(integer, &exponent), 53));
  uint32_t limbs[kMostLimbs]{static_cast<uint32_t>(mantissa % kBase),
                             static_cast<uint32_t>(mantissa / kBase % kBase)};
  int count = 2;
  for (int i = 53; i < exponent; ++i) {
    uint32_t carry = 0;
    for (int k = 0; k < count; ++k) {
      const uint32_t doubled = 2 * limbs[k] + carry;
      limbs[k] = doubled % kBase;
      carry = doubled / kBase;
    }
    if (carry > 0) limbs[count++] = carry;
  }
  char text[kMostLimbs * kDigits], *end = text + sizeof(text), *begin = end;
  for (int k = 0; k < count; ++k)
    for (uint32_t digit = 0, rest = limbs[k]; digit < kDigits; ++digit, rest /= 10)
      *--begin = static_cast<char>('0' + rest % 10);
  while (*begin == '0') ++begin;
  if (last - first < end - begin) return {last, errc::value_too_large};
  std::memcpy(first, begin, static_cast<size_t>(end - begin));
  return {first + (end - begin), errc{}};
}

_LIBCPP_END_NAMESPACE_STD
