/// The names that all outputs share, declared once: of the fields of a result, and of enumerators. The
/// command, report.json, Python and JavaScript have them from here.
///
/// Threads: constants.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>

namespace sdm {

/// A field of a struct.
template <class Struct, class Value>
struct Field {
  const char* name;  ///< in JSON and Python; JavaScript has it in camel case
  Value Struct::*member;
  const char* text;    ///< what it is, one sentence
  bool index = false;  ///< kNone stands for none: null in JSON, None in Python
};

/// The fields of a struct, a std::tuple of Field in the order of outputs; nullptr of one that declares none.
template <class Struct>
inline constexpr auto kFields = nullptr;

/// A struct that declares its fields.
template <class Struct>
concept Declared = !std::is_null_pointer_v<std::remove_cv_t<decltype(kFields<Struct>)>>;

/// Calls visit(field) for each field of a struct.
template <class Struct, class Visit>
constexpr void for_each_field(const Visit& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, kFields<Struct>);
}

/// The words of an enumeration whose values are 0, 1, …: a std::array of const char* in their order; nullptr
/// of one that declares none.
template <class Enum>
inline constexpr auto kWords = nullptr;

template <class Enum>
concept Worded = std::is_enum_v<Enum> && !std::is_null_pointer_v<std::remove_cv_t<decltype(kWords<Enum>)>>;

/// The word of an enumerator.
template <Worded Enum>
[[nodiscard]] constexpr const char* name_of(Enum value) {
  return kWords<Enum>[static_cast<std::size_t>(value)];
}

/// The enumerator of a word; nothing if there is none.
template <Worded Enum>
[[nodiscard]] constexpr std::optional<Enum> value_of(std::string_view word) {
  for (std::size_t i = 0; i < kWords<Enum>.size(); ++i)
    if (word == kWords<Enum>[i]) return static_cast<Enum>(i);
  return std::nullopt;
}

}  // namespace sdm
