// Options as JavaScript gives them, by the names that structs declare (sdm/options.h).
#pragma once

#include <sdm/error.h>
#include <sdm/options.h>
#include <sdm/tolerance.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

namespace sdm::js {

/// What js/src/given.ts makes of an object: for each property a line of its name, "=" and its value in words,
/// a string in quotes; and a number, NaN if the value is none.
struct GivenOptions {
  const char* lines;
  std::uint32_t bytes;
  const double* numbers;
};

struct GivenValue {
  std::string_view name, words;
  double number;

  /// The string; empty if the value is none.
  [[nodiscard]] std::string_view text() const {
    return words.starts_with('"') ? words.substr(1, words.size() - 2) : std::string_view();
  }
  /// The string, or the numbers with commas between them.
  [[nodiscard]] std::string_view text_or_numbers() const { return text().empty() ? words : text(); }
};

/// Reads a number, a text T or LO:HI, or an array of two numbers, of which one may be infinite: no limit.
/// Returns false, and changes nothing, for anything else.
[[nodiscard]] bool read_tolerance(const GivenValue& given, std::optional<Tolerance>& value);

[[nodiscard]] std::vector<GivenValue> values_of(const GivenOptions& given);

/// Sets the option of a struct. Returns false, and changes nothing, for a value of another kind or out of
/// range.
template <class Struct, class Value>
[[nodiscard]] bool set(const Option<Struct, Value>& option, const GivenValue& given, Struct& options) {
  using Type = typename detail::OptionalOf<Value>::Type;
  if constexpr (std::is_same_v<Type, bool>) {
    return read_value(option, given.words, options);
  } else if constexpr (std::is_arithmetic_v<Type>) {
    if (!in_range(given.number, option.range)) return false;
    if (std::is_integral_v<Type> && given.number != std::floor(given.number)) return false;
    options.*option.member = static_cast<Type>(given.number);
    return true;
  } else if constexpr (std::is_same_v<Type, Tolerance>) {
    return read_tolerance(given, options.*option.member);
  } else if constexpr (std::is_same_v<Type, Vec3> || std::is_same_v<Type, std::vector<double>> ||
                       std::is_same_v<Type, std::array<double, 2>>) {
    return read_value(option, given.text_or_numbers(), options);
  } else if constexpr (std::is_same_v<Type, std::string>) {
    return given.words.starts_with('"') && read_value(option, given.text(), options);
  } else {
    return read_value(option, given.text(), options);
  }
}

/// The option that is meant by a value. Throws sdm::Error if there is none of its name.
[[nodiscard]] const OptionInfo& option_of(const GivenValue& given, std::span<const OptionInfo> declared);
/// Throws sdm::Error: the option does not take the value.
[[noreturn]] void refuse(const OptionInfo& option, const GivenValue& given);

/// The options of several structs. Throws sdm::Error for a name that none of them has, for a value that they
/// do not take, and for two that exclude each other.
template <class... Structs>
[[nodiscard]] std::tuple<Structs...> read_all_options(const GivenOptions& given) {
  const std::vector<OptionInfo> declared = options_of<Structs...>();
  std::tuple<Structs...> all;
  std::vector<GivenOption> read;
  for (const GivenValue& value : values_of(given)) {
    const OptionInfo& info = option_of(value, declared);
    const auto read_into = [&]<class Struct>(Struct& options) {
      for_each_option<Struct>([&](const auto& option) {
        if (option.name == info.name && !set(option, value, options)) refuse(info, value);
      });
    };
    std::apply([&](auto&... options) { (read_into(options), ...); }, all);
    read.push_back({info.name, std::string(value.text())});
  }
  check_exclusions(declared, read, Spelling::camel_case);
  return all;
}

/// The same of one struct.
template <class Struct>
[[nodiscard]] Struct read_options(const GivenOptions& given) {
  return std::get<0>(read_all_options<Struct>(given));
}

}  // namespace sdm::js
