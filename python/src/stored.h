// How objects are pickled and copied: as tuples of plain values, which are checked when they come back.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/error.h>

#include <cstring>
#include <type_traits>
#include <vector>

namespace sdm::python {

namespace nb = nanobind;

inline constexpr const char* kDamaged = "the pickle is damaged, or of another version of sdm";

/// The items of a tuple of `count`. Throws sdm::Error for anything else.
inline nb::tuple items(nb::handle state, std::size_t count) {
  if (!nb::isinstance<nb::tuple>(state) || nb::len(state) != count) throw Error(kDamaged);
  return nb::borrow<nb::tuple>(state);
}

/// A copy of plain values, as bytes.
template <class Element>
nb::object packed(const std::vector<Element>& values) {
  static_assert(std::is_trivially_copyable_v<Element>);
  return nb::bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Element));
}

/// The values of packed(). Throws sdm::Error if there is a part of one.
template <class Element>
std::vector<Element> unpacked(nb::handle packed) {
  const auto bytes = nb::cast<nb::bytes>(packed);
  if (bytes.size() % sizeof(Element) != 0) throw Error(kDamaged);
  std::vector<Element> values(bytes.size() / sizeof(Element));
  if (!values.empty()) std::memcpy(values.data(), bytes.c_str(), bytes.size());
  return values;
}

/// A method that stores the object as a tuple of `count`, and one that makes it again from that.
template <class Object, class State, class Make>
void bind_state(std::size_t count, State state, Make make) {
  nb::borrow<nb::class_<Object>>(nb::type<Object>())
      .def("__getstate__", state, nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"))
      .def(
          "__setstate__",
          [count, make](Object& self, const nb::tuple& from) {
            try {
              make(&self, items(from, count));
            } catch (const std::bad_cast&) {
              throw Error(kDamaged);
            }
          },
          nb::arg("state"), nb::sig("def __setstate__(self, state: tuple[typing.Any, ...], /) -> None"));
}

/// Makes pickle and copy refuse the objects of a class: `sentence` says what to do instead.
template <class Object>
void bind_no_state(const char* sentence) {
  nb::borrow<nb::class_<Object>>(nb::type<Object>())
      .def(
          "__reduce__", [sentence](nb::handle) -> nb::object { throw nb::type_error(sentence); },
          nb::sig("def __reduce__(self) -> typing.NoReturn"));
}

/// An enumerator from 0 to the last one.
template <class Enum>
Enum enumerator(nb::handle number, Enum last) {
  const int value = nb::cast<int>(number);
  if (value < 0 || value > static_cast<int>(last)) throw Error(kDamaged);
  return static_cast<Enum>(value);
}

}  // namespace sdm::python
