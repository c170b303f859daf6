// Results of the exported functions, as JavaScript reads them.
#pragma once

#include <sdm/execution.h>
#include <sdm/names.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#define SDM_EXPORT(name) extern "C" __attribute__((export_name(#name)))

namespace sdm::js {

/// An array in the memory of the module.
struct View {
  const void* data = nullptr;
  std::uint32_t bytes = 0;
};

/// Values by their names that a function returns, or why there are none. JavaScript reads the public members
/// by their offsets (js/src/module.ts), copies the arrays and frees the result with sdm_free_result().
class Result {
 public:
  enum class Error : std::uint32_t { none, input, cancelled, memory };
  Error error = Error::none;
  View message;  ///< of an error, in UTF-8
  View names;    ///< a line for each value: its name, a blank, and how it is read (js/src/results.ts)
  View numbers;  ///< of all values that are numbers, in their order
  std::uint32_t count = 0;
  static constexpr std::size_t kMostArrays = 12;
  View arrays[kMostArrays];

  /// A number, a flag, a word of an enumeration, a text of one line, an array of numbers, or an optional one
  /// of these. `name`: as of a field; "/" leads into an object or, before a number, a list.
  template <class Value>
  void put(std::string_view name, const Value& value) {
    if constexpr (std::is_same_v<Value, bool>) {
      numbers_.push_back(value ? 1 : 0);
      add_line(name, "flag");
    } else if constexpr (Worded<Value>) {
      add_line(name, std::string("=") + name_of(value));
    } else if constexpr (std::is_convertible_v<const Value&, std::string_view>) {
      add_line(name, "=" + std::string(value));
    } else if constexpr (requires { value.has_value(); }) {
      value ? put(name, *value) : add_line(name, "null");
    } else {
      add_line(name, shape_of(value));
    }
  }
  /// An array of numbers, of arrays of numbers, of enumerators, or of structs as bytes.
  template <class T>
  void put(std::string_view name, std::vector<T> values) {
    auto kept = std::make_shared<std::vector<T>>(std::move(values));
    put_view<T>(name, *kept);
    kept_.push_back(std::move(kept));
  }
  /// The same of an array that stays where it is until JavaScript has copied it.
  template <class T>
  void put_view(std::string_view name, std::span<const T> values) {
    add_array(name, element_of<T>(), std::as_bytes(values));
  }
  /// A text of any length.
  void put_text(std::string_view name, std::string text) {
    auto kept = std::make_shared<std::string>(std::move(text));
    add_array(name, "text", std::as_bytes(std::span<const char>(*kept)));
    kept_.push_back(std::move(kept));
  }
  /// The fields of a struct. `path`: the name of the object that they are in, and "/"; empty: the result
  /// itself.
  template <class Struct>
  void put_fields(const std::string& path, const Struct& of) {
    for_each_field<Struct>([&](const auto& field) { put(path + field.name, of.*field.member); });
  }
  /// An object that JavaScript keeps by its `address`, until it calls the function that frees it. Of this
  /// result until hand_over(), so that it is freed if what follows fails.
  template <class T>
  void put_object(std::unique_ptr<T> object) {
    put("address", reinterpret_cast<std::uintptr_t>(object.get()));
    objects_.emplace_back(nullptr, [](void* of) { delete static_cast<T*>(of); });
    objects_.back().reset(object.release());
  }
  /// Once all values are there.
  void hand_over() noexcept {
    names = {names_.data(), static_cast<std::uint32_t>(names_.size())};
    numbers = {numbers_.data(), static_cast<std::uint32_t>(numbers_.size() * sizeof(double))};
    for (auto& object : objects_) static_cast<void>(object.release());
  }
  void fail(Error kind, std::string text) {
    text_ = std::move(text);
    fail_with_literal(kind, text_);
  }
  /// Takes no memory: the text has to stay.
  void fail_with_literal(Error kind, std::string_view text) noexcept {
    error = kind;
    message = {text.data(), static_cast<std::uint32_t>(text.size())};
  }

 private:
  void add_line(std::string_view name, std::string_view kind);
  void add_array(std::string_view name, std::string_view kind, std::span<const std::byte> bytes);

  /// Such as "number" or, of two points, "2x3"; adds the numbers.
  template <class Value>
  std::string shape_of(const Value& value) {
    if constexpr (std::is_arithmetic_v<Value>) {
      numbers_.push_back(static_cast<double>(value));
      return "number";
    } else {
      std::string inner;
      for (const auto& one : value) inner = shape_of(one);
      return std::to_string(value.size()) + (inner == "number" ? "" : "x" + inner);
    }
  }
  /// Such as "f64" of points, or "u8", also of structs.
  template <class T>
  static std::string element_of() {
    if constexpr (requires { typename T::value_type; })
      return element_of<typename T::value_type>();
    else if constexpr (std::is_class_v<T>)
      return "u8";
    else
      return (std::is_floating_point_v<T> ? "f" : "u") + std::to_string(8 * sizeof(T));
  }

  std::string names_;
  std::vector<double> numbers_;
  std::vector<std::shared_ptr<void>> kept_;
  std::vector<std::unique_ptr<void, void (*)(void*)>> objects_;
  std::string text_;
};

void fail_with_current_exception(Result& result) noexcept;
/// Of a call for whose own result there is no memory. It is not freed.
[[nodiscard]] Result* result_without_memory() noexcept;
/// What the present call obeys, see sdm_obey().
[[nodiscard]] const std::atomic<bool>& cancel_flag() noexcept;

/// Calls compute(result) and turns exceptions into errors.
template <class Compute>
Result* guarded(const Compute& compute) noexcept {
  auto* result = new (std::nothrow) Result;
  if (!result) return result_without_memory();
  try {
    const CancelScope scope(cancel_flag());
    compute(*result);
    result->hand_over();
  } catch (...) {
    fail_with_current_exception(*result);
  }
  return result;
}

}  // namespace sdm::js
