// Arrays in assertions.
#pragma once

#include <algorithm>
#include <vector>

#include "core/arrays/array.h"

namespace sdm::core {

template <class T>
bool operator==(const Array<T>& a, const Array<T>& b) {
  return std::ranges::equal(a, b);
}
template <class T>
bool operator==(const Array<T>& a, const std::vector<T>& b) {
  return std::ranges::equal(a, b);
}

}  // namespace sdm::core
