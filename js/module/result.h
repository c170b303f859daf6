// Results of the exported functions, as JavaScript reads them.
#pragma once

#include <sdm/cancellation.h>
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
#include <utility>
#include <vector>

#define SDM_EXPORT(name) extern "C" __attribute__((export_name(#name)))

namespace sdm::js {

/// An array in the memory of the module.
struct View {
  const void* data = nullptr;
  std::uint32_t bytes = 0;
};

/// Arrays that a function returns, or why there are none. JavaScript reads the public members by their
/// offsets (js/src/module.ts), copies the arrays and frees the result with sdm_free_result().
class Result {
 public:
  enum class Error : std::uint32_t { none, input, cancelled, memory };
  Error error = Error::none;
  View message;  ///< of an error, in UTF-8
  std::uint32_t count = 0;
  static constexpr std::size_t kMostArrays = 12;
  View arrays[kMostArrays];

  template <class T>
  void add(std::vector<T> values) {
    auto kept = std::make_shared<std::vector<T>>(std::move(values));
    add_view(std::as_bytes(std::span(*kept)));
    kept_.push_back(std::move(kept));
  }
  /// Numbers, as one array of double.
  template <class... Numbers>
  void add_numbers(Numbers... numbers) {
    add(std::vector<double>{static_cast<double>(numbers)...});
  }
  /// The names of the fields of a struct, divided by spaces, and their numbers.
  template <class Struct>
  void add_fields(const Struct& of) {
    std::string names;
    std::vector<double> numbers;
    for_each_field<Struct>([&](const auto& field) {
      names += names.empty() ? "" : " ";
      names += field.name;
      numbers.push_back(static_cast<double>(of.*field.member));
    });
    add_text(names);
    add(std::move(numbers));
  }
  void add_text(std::string_view text) { add(std::vector<char>(text.begin(), text.end())); }
  /// An object that JavaScript keeps by its address, until it calls the function that frees it. Of this
  /// result until hand_over(), so that it is freed if what follows fails.
  template <class T>
  void add_object(std::unique_ptr<T> object) {
    add_numbers(reinterpret_cast<std::uintptr_t>(object.get()));
    objects_.emplace_back(nullptr, [](void* of) { delete static_cast<T*>(of); });
    objects_.back().reset(object.release());
  }
  void hand_over() noexcept {
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
  void add_view(std::span<const std::byte> bytes) {
    arrays[count++] = {bytes.data(), static_cast<std::uint32_t>(bytes.size())};
  }
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
