/// What the values of options may be, and how they are read from text, written and checked: for
/// sdm/options.h, which has what is declared of options.
///
/// Threads: the functions may be called concurrently.
#pragma once

#include <sdm/api.h>
#include <sdm/names.h>
#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sdm {

/// The numbers that an option may be: from `least` to `most`.
struct OptionRange {
  double least = std::numeric_limits<double>::lowest();  ///< the lowest number there is: no limit but finite
  double most = std::numeric_limits<double>::max();      ///< the same
  bool above = false;                                    ///< whether `least` itself is excluded
  bool below = false;                                    ///< whether `most` itself is excluded
  bool square = false;  ///< whether only squares of whole numbers are allowed
};
/// The finite numbers greater than 0.
inline constexpr OptionRange kPositive{0, std::numeric_limits<double>::max(), true};
/// The same, and infinity.
inline constexpr OptionRange kPositiveOrInfinite{0, std::numeric_limits<double>::infinity(), true};

/// An angle between normals, in degrees.
inline constexpr OptionRange kAngle{.least = 0, .most = 180, .above = true};

/// Reads all of a text as a number in base 10. Returns false, and changes nothing, if it is none or out of
/// range.
[[nodiscard]] SDM_API bool read_number(std::string_view text, const OptionRange& range, double& value);
/// The same of a whole number, at least 0.
[[nodiscard]] SDM_API bool read_number(std::string_view text, const OptionRange& range, std::uint64_t& value);
/// The same of numbers with one comma between two of them; `count`: of how many, 0: any.
[[nodiscard]] SDM_API bool read_numbers(std::string_view text, const OptionRange& range, std::size_t count,
                                        std::vector<double>& values);
/// The same of a direction X,Y,Z other than 0,0,0, or of "normal" for nothing.
[[nodiscard]] SDM_API bool read_direction(std::string_view text, std::optional<Vec3>& value);

/// A number as text, by which it can be read again.
[[nodiscard]] SDM_API std::string text_of(double value);
/// The same of several.
[[nodiscard]] SDM_API std::string text_of(std::span<const double> values);
/// The same of a direction.
[[nodiscard]] SDM_API std::string text_of(const std::optional<Vec3>& direction);

/// Whether the vector has a direction: it is finite, its length too, and not 0.
[[nodiscard]] SDM_API bool has_direction(const Vec3& vector);
/// Whether a number is in a range.
[[nodiscard]] constexpr bool in_range(double value, const OptionRange& range) {
  if (range.square) {
    double root = 0;
    while (root * root < value && root * root < range.most) ++root;
    if (root * root != value) return false;
  }
  return (range.above ? value > range.least : value >= range.least) &&
         (range.below ? value < range.most : value <= range.most);
}

/// How the values of an option are read from text, written and checked, beside each type that they may have:
///
///     static constexpr const char* kType;  // what it is, for the types of other languages
///     static std::string needed();         // what a value must be; empty: of a number in range, or a word
///     static bool read(std::string_view text, const OptionRange& range, Value& value);  // as read_number()
///     static std::string text(const Value& value);                                       // read() reads it
///     static bool allowed(const Value& value, const OptionRange& range);
template <class Value>
struct OptionForm;

template <>
struct OptionForm<bool> {
  static constexpr const char* kType = "flag";
  static std::string needed() { return "true or false"; }
  static bool read(std::string_view text, const OptionRange&, bool& value) {
    if (text != "true" && text != "false") return false;
    value = text == "true";
    return true;
  }
  static std::string text(bool value) { return value ? "true" : "false"; }
  static bool allowed(bool, const OptionRange&) { return true; }
};

template <Worded Value>
struct OptionForm<Value> {
  static constexpr const char* kType = "word";
  static std::string needed() { return {}; }
  static bool read(std::string_view text, const OptionRange&, Value& value) {
    const std::optional<Value> word = value_of<Value>(text);
    if (word) value = *word;
    return word.has_value();
  }
  static std::string text(Value value) { return name_of(value); }
  static bool allowed(Value, const OptionRange&) { return true; }
};

template <>
struct OptionForm<double> {
  static constexpr const char* kType = "number";
  static std::string needed() { return {}; }
  static bool read(std::string_view text, const OptionRange& range, double& value) {
    return read_number(text, range, value);
  }
  static std::string text(double value) { return text_of(value); }
  static bool allowed(double value, const OptionRange& range) { return in_range(value, range); }
};

template <std::integral Value>
struct OptionForm<Value> {
  static constexpr const char* kType = "integer";
  static std::string needed() { return {}; }
  static bool read(std::string_view text, const OptionRange& range, Value& value) {
    std::uint64_t number = 0;
    if (!read_number(text, range, number) || !std::in_range<Value>(number)) return false;
    value = static_cast<Value>(number);
    return true;
  }
  static std::string text(Value value) { return std::to_string(value); }
  static bool allowed(Value value, const OptionRange& range) {
    return in_range(static_cast<double>(value), range);
  }
};

/// A name, such as that of a unit.
template <>
struct OptionForm<std::string> {
  static constexpr const char* kType = "text";
  static std::string needed() { return "text"; }
  static bool read(std::string_view text, const OptionRange&, std::string& value) {
    value = text;
    return true;
  }
  static std::string text(const std::string& value) { return value; }
  static bool allowed(const std::string&, const OptionRange&) { return true; }
};

/// Words that are no enumeration, with a comma between two of them.
template <>
struct OptionForm<std::vector<std::string>> {
  static constexpr const char* kType = "texts";
  static std::string needed() { return "words with commas between them"; }
  SDM_API static bool read(std::string_view text, const OptionRange& range, std::vector<std::string>& values);
  SDM_API static std::string text(const std::vector<std::string>& values);
  static bool allowed(const std::vector<std::string>&, const OptionRange&) { return true; }
};

/// Each of the numbers is in the range.
template <>
struct OptionForm<std::vector<double>> {
  static constexpr const char* kType = "numbers";
  static std::string needed() { return {}; }
  static bool read(std::string_view text, const OptionRange& range, std::vector<double>& values) {
    return read_numbers(text, range, 0, values);
  }
  static std::string text(const std::vector<double>& values) { return text_of(values); }
  static bool allowed(const std::vector<double>& values, const OptionRange& range) {
    return std::ranges::all_of(values, [&](double value) { return in_range(value, range); });
  }
};

/// The ends of an interval.
template <>
struct OptionForm<std::array<double, 2>> {
  static constexpr const char* kType = "interval";
  static std::string needed() { return "two numbers, the smaller one first"; }
  static bool read(std::string_view text, const OptionRange& range, std::array<double, 2>& value) {
    std::vector<double> numbers;
    if (!read_numbers(text, range, 2, numbers) || !(numbers[0] < numbers[1])) return false;
    value = {numbers[0], numbers[1]};
    return true;
  }
  static std::string text(const std::array<double, 2>& value) { return text_of(value); }
  static bool allowed(const std::array<double, 2>& value, const OptionRange& range) {
    return value[0] < value[1] && in_range(value[0], range) && in_range(value[1], range) &&
           in_range(value[1] - value[0], range);
  }
};

/// A point, or a direction.
template <>
struct OptionForm<Vec3> {
  static constexpr const char* kType = "point";
  static std::string needed() { return "three numbers"; }
  static bool read(std::string_view text, const OptionRange& range, Vec3& value) {
    std::vector<double> numbers;
    if (!read_numbers(text, range, 3, numbers)) return false;
    value = {numbers[0], numbers[1], numbers[2]};
    return true;
  }
  static std::string text(const Vec3& value) { return text_of(std::span<const double>(value)); }
  static bool allowed(const Vec3& value, const OptionRange& range) {
    return std::ranges::all_of(value, [&](double x) { return in_range(x, range); });
  }
};

/// A direction; nothing: normals.
template <>
struct OptionForm<std::optional<Vec3>> {
  static constexpr const char* kType = "direction";
  static std::string needed() { return "normal or a direction of three numbers, not all 0"; }
  static bool read(std::string_view text, const OptionRange&, std::optional<Vec3>& value) {
    return read_direction(text, value);
  }
  static std::string text(const std::optional<Vec3>& value) { return text_of(value); }
  static bool allowed(const std::optional<Vec3>& value, const OptionRange&) {
    return !value || has_direction(*value);
  }
};

template <class Value>
struct OptionForm<std::optional<Value>> {
  static constexpr const char* kType = OptionForm<Value>::kType;
  static std::string needed() { return OptionForm<Value>::needed(); }
  static bool read(std::string_view text, const OptionRange& range, std::optional<Value>& value) {
    Value given{};
    if (!OptionForm<Value>::read(text, range, given)) return false;
    value = std::move(given);
    return true;
  }
  static std::string text(const std::optional<Value>& value) {
    return value ? OptionForm<Value>::text(*value) : std::string();
  }
  static bool allowed(const std::optional<Value>& value, const OptionRange& range) {
    return !value || OptionForm<Value>::allowed(*value, range);
  }
};

}  // namespace sdm
