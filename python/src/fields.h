// Declared fields of results (sdm/names.h) in Python: numbers and texts as they are, enumerators as their
// words, points and vectors as arrays, the limits of a tolerance as a tuple, and results that are no class of
// their own as a dict.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <sdm/align.h>
#include <sdm/names.h>
#include <sdm/places.h>
#include <sdm/points.h>
#include <sdm/tolerance.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.h"

namespace sdm::python {

/// The word for a verdict: that of the command, in small letters.
[[nodiscard]] std::string word_of(Verdict verdict);

/// Results that are a dict.
template <class Value>
inline constexpr bool kIsDict = std::is_same_v<Value, AlignResiduals> || std::is_same_v<Value, PlaceTotals> ||
                                std::is_same_v<Value, TextDialect>;

template <class Struct>
nb::dict dict_of_fields(const Struct& of);

/// A value as Python has it.
inline nb::object value_of_field(const Vec3& value) {
  return vector_of(value);
}
inline nb::object value_of_field(const std::array<Vec3, 2>& value) {
  return array_of<double>(std::vector{value}, {2, 3});
}
inline nb::object value_of_field(const std::vector<float>& value) {
  return array_of<float>(std::vector(value), {value.size()});
}
inline nb::object value_of_field(const Transform& value) {
  return matrix(value);
}
inline nb::object value_of_field(const Tolerance& value) {
  return nb::make_tuple(value.lower, value.upper);
}
inline nb::object value_of_field(const std::array<std::uint32_t, 2>& value) {
  return nb::make_tuple(value[0], value[1]);
}
inline nb::object value_of_field(Verdict value) {
  return nb::cast(word_of(value));
}
inline nb::object value_of_field(const std::array<DegreeOfFreedom, 6>& value) {
  return nb::cast(std::vector(value.begin(), value.end()));
}
template <class Value>
nb::object value_of_field(const Value& value) {
  if constexpr (Worded<Value>)
    return nb::str(name_of(value));
  else if constexpr (kIsDict<Value>)
    return dict_of_fields(value);
  else
    return nb::cast(value);
}
template <class Value>
nb::object value_of_field(const std::optional<Value>& value) {
  return value ? value_of_field(*value) : nb::none();
}

/// The type of a value that value_of_field() converts, and a note on the shape of an array.
template <class Value>
struct FieldType;
template <Worded Value>
struct FieldType<Value> {
  static std::string name() {
    std::string words;
    for (const char* word : kWords<Value>) words += (words.empty() ? "'" : ", '") + std::string(word) + "'";
    return "typing.Literal[" + words + "]";
  }
  static constexpr const char* kShape = "";
};
template <>
struct FieldType<Verdict> {
  static std::string name() {
    std::string words;
    for (std::size_t i = 0; i < kWords<Verdict>.size(); ++i)
      words += (words.empty() ? "'" : ", '") + word_of(static_cast<Verdict>(i)) + "'";
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
template <>
struct FieldType<std::vector<float>> {
  static std::string name() { return "numpy.typing.NDArray[numpy.float32]"; }
  static constexpr const char* kShape = " (m,) float32.";
};
template <>
struct FieldType<Transform> {
  static std::string name() { return "numpy.typing.NDArray[numpy.float64]"; }
  static constexpr const char* kShape = " (4, 4) float64.";
};
template <>
struct FieldType<Tolerance> {
  static std::string name() { return "tuple[float, float]"; }
  static constexpr const char* kShape = "";
};
template <>
struct FieldType<std::array<std::uint32_t, 2>> {
  static std::string name() { return "tuple[int, int]"; }
  static constexpr const char* kShape = "";
};
template <>
struct FieldType<std::array<DegreeOfFreedom, 6>> {
  static std::string name() { return "list[DegreeOfFreedom]"; }
  static constexpr const char* kShape = "";
};
template <class Value>
requires kIsDict<Value>
struct FieldType<Value> {
  static std::string name() { return "dict[str, object]"; }
  static constexpr const char* kShape = "";
};
template <class Value>
requires requires {
  FieldType<Value>::kShape;
}
struct FieldType<std::optional<Value>> {
  static std::string name() { return FieldType<Value>::name() + " | None"; }
  static constexpr const char* kShape = FieldType<Value>::kShape;
};

/// Whether value_of_field() converts a member; nanobind has others as they are.
template <class Value>
concept Converted = requires {
  FieldType<Value>::kShape;
};

/// Adds a property for each declared field of what get(object) refers to, with its sentence; not for those
/// that are `without`, which the type has in another form.
template <class Struct, class Class, class Get>
nb::class_<Class>& bind_fields_of(nb::class_<Class>& type, Get get,
                                  std::initializer_list<std::string_view> without = {}) {
  for_each_field<Struct>([&](const auto& field) {
    for (const std::string_view name : without)
      if (name == field.name) return;
    using Value = std::remove_cvref_t<decltype(std::declval<const Struct&>().*field.member)>;
    const auto add = [&](const std::string& annotation, const char* shape, auto value) {
      const std::string signature = "def " + std::string(field.name) + "(self) -> " + annotation;
      const std::string text = std::string(field.text) + shape;
      type.def_prop_ro(field.name, value, nb::sig(signature.c_str()), text.c_str());
    };
    if constexpr (Converted<Value>) {
      add(FieldType<Value>::name(), FieldType<Value>::kShape,
          [get, field](const Class& self) { return value_of_field(get(self).*field.member); });
    } else if (field.index) {
      add("int | None", "", [get, field](const Class& self) -> nb::object {
        const auto& value = get(self).*field.member;
        return is_no_index(field, value) ? nb::none() : nb::cast(value);
      });
    } else {
      type.def_prop_ro(
          field.name, [get, field](const Class& self) -> const Value& { return get(self).*field.member; },
          field.text);
    }
  });
  return type;
}

/// The same of an object that is the result.
template <class Struct>
nb::class_<Struct>& bind_fields(nb::class_<Struct>& type,
                                std::initializer_list<std::string_view> without = {}) {
  return bind_fields_of<Struct>(
      type, [](const Struct& self) -> const Struct& { return self; }, without);
}

/// The sentence of a declared field, for a property that has it in another form.
template <class Struct>
std::string text_of_field(std::string_view name) {
  std::string text;
  for_each_field<Struct>([&](const auto& field) {
    if (name == field.name) text = field.text;
  });
  return text;
}

/// The declared fields of a result as a dict.
template <class Struct>
nb::dict dict_of_fields(const Struct& of) {
  nb::dict result;
  for_each_field<Struct>([&](const auto& field) { result[field.name] = value_of_field(of.*field.member); });
  return result;
}

/// The type and the shape of the column of a field.
template <class Value>
struct ColumnType;
template <>
struct ColumnType<Vec3> {
  static constexpr const char* kScalar = "float64";
  static constexpr const char* kShape = "(n, 3)";
};
template <>
struct ColumnType<double> {
  static constexpr const char* kScalar = "float64";
  static constexpr const char* kShape = "(n,)";
};
template <>
struct ColumnType<std::uint32_t> {
  static constexpr const char* kScalar = "uint32";
  static constexpr const char* kShape = "(n,)";
};
template <>
struct ColumnType<std::uint64_t> {
  static constexpr const char* kScalar = "uint64";
  static constexpr const char* kShape = "(n,)";
};

/// The arrays of the declared fields of many results, one for each.
template <class Struct>
using Columns = std::array<LazyArray, std::tuple_size_v<std::remove_cvref_t<decltype(kFields<Struct>)>>>;

/// Adds an array for each declared field: rows(object) are the results, `columns` keeps the arrays.
template <class Struct, class Class, class Rows>
void bind_columns(nb::class_<Class>& type, Columns<Struct> Class::*columns, Rows rows) {
  std::size_t index = 0;
  for_each_field<Struct>([&](const auto& field) {
    using Type = ColumnType<std::remove_cvref_t<decltype(std::declval<const Struct&>().*field.member)>>;
    const std::string scalar = Type::kScalar;
    const std::string signature =
        "def " + std::string(field.name) + "(self) -> numpy.typing.NDArray[numpy." + scalar + "]";
    const std::string text = std::string(field.text) + " " + Type::kShape + " " + scalar + ".";
    type.def_prop_ro(
        field.name,
        [columns, rows, field, index](Class& self) {
          return (self.*columns)[index].get(
              [&] { return column(rows(self), [&](const Struct& of) { return of.*field.member; }); });
        },
        nb::sig(signature.c_str()), text.c_str());
    ++index;
  });
}

}  // namespace sdm::python
