// Declared fields of results (sdm/names.h) in Python: numbers and texts as they are, enumerators as their
// words, points and vectors as arrays.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <sdm/names.h>
#include <sdm/types.h>

#include <array>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.h"

namespace sdm::python {

/// A value as Python has it, its type there, and a note on the shape of an array.
inline nb::object value_of_field(const Vec3& value) {
  return vector_of(value);
}
inline nb::object value_of_field(const std::array<Vec3, 2>& value) {
  return array_of<double>(std::vector{value}, {2, 3});
}
template <class Value>
nb::object value_of_field(const Value& value) {
  if constexpr (Worded<Value>)
    return nb::str(name_of(value));
  else
    return nb::cast(value);
}
template <class Value>
nb::object value_of_field(const std::optional<Value>& value) {
  return value ? value_of_field(*value) : nb::none();
}

template <class Value>
struct FieldType {
  static std::string name() {
    std::string words;
    for (const char* word : kWords<Value>) words += (words.empty() ? "'" : ", '") + std::string(word) + "'";
    return "typing.Literal[" + words + "]";
  }
  static constexpr const char* kShape = "";
};
template <>
struct FieldType<Vec3> {
  static std::string name() { return "numpy.typing.NDArray[numpy.float64]"; }
  static constexpr const char* kShape = " (3,) float64.";
};
template <>
struct FieldType<std::array<Vec3, 2>> {
  static std::string name() { return "numpy.typing.NDArray[numpy.float64]"; }
  static constexpr const char* kShape = " (2, 3) float64.";
};
template <class Value>
struct FieldType<std::optional<Value>> {
  static std::string name() { return FieldType<Value>::name() + " | None"; }
  static constexpr const char* kShape = FieldType<Value>::kShape;
};

/// Whether nanobind has the value of a member as it is.
template <class Value>
inline constexpr bool kPlainField = std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string> ||
                                    std::is_same_v<Value, std::optional<double>>;

/// Adds a property for each declared field, with its sentence.
template <class Struct>
nb::class_<Struct>& bind_fields(nb::class_<Struct>& type) {
  for_each_field<Struct>([&](const auto& field) {
    const auto member = field.member;
    using Value = std::remove_cvref_t<decltype(std::declval<Struct>().*member)>;
    if constexpr (kPlainField<Value>) {
      type.def_ro(field.name, member, field.text);
    } else {
      const std::string signature =
          "def " + std::string(field.name) + "(self) -> " + FieldType<Value>::name();
      const std::string text = std::string(field.text) + FieldType<Value>::kShape;
      type.def_prop_ro(
          field.name, [member](const Struct& self) { return value_of_field(self.*member); },
          nb::sig(signature.c_str()), text.c_str());
    }
  });
  return type;
}

/// The declared fields of a result as a dict.
template <class Struct>
nb::dict dict_of_fields(const Struct& of) {
  nb::dict result;
  for_each_field<Struct>([&](const auto& field) { result[field.name] = value_of_field(of.*field.member); });
  return result;
}

}  // namespace sdm::python
