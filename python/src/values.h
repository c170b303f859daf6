// Values as bytes: how objects that consist of plain values are pickled and copied. A type is stored by its
// members, which kMembers lists beside its binding.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/sdm.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "stored.h"

namespace sdm::python {

/// A std::tuple of the members that a value is stored by: those of its fields if it declares any; of another,
/// beside its binding. Those of a base class are listed like its own.
template <class Value>
inline constexpr auto kMembers = [] {
  if constexpr (std::is_null_pointer_v<std::remove_cv_t<decltype(kFields<Value>)>>)
    return nullptr;
  else
    return std::apply([](const auto&... field) { return std::tuple{field.member...}; }, kFields<Value>);
}();
/// The last enumerator of an enumeration that starts at 0; of one without words, beside its binding.
template <class Enum>
inline constexpr auto kLast = [] {
  if constexpr (Worded<Enum>)
    return static_cast<Enum>(kWords<Enum>.size() - 1);
  else
    return nullptr;
}();

namespace detail {

/// A std::array, or one by another name, as Vec3.
template <class Value>
inline constexpr bool kIsArray = requires(const Value& value) {
  []<class Element, std::size_t n>(const std::array<Element, n>&) {}(value);
};
template <class>
inline constexpr bool kIsVector = false;
template <class Element>
inline constexpr bool kIsVector<std::vector<Element>> = true;
template <class>
inline constexpr bool kIsOptional = false;
template <class Value>
inline constexpr bool kIsOptional<std::optional<Value>> = true;

/// Whether any bytes of its size are a value: numbers, and arrays of them.
template <class Value>
constexpr bool is_plain() {
  if constexpr (kIsArray<Value>)
    return is_plain<typename Value::value_type>();
  else
    return std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>;
}

class ValueWriter {
 public:
  template <class Value>
  void write(const Value& value) {
    if constexpr (is_plain<Value>()) {
      append(&value, sizeof(Value));
    } else if constexpr (std::is_same_v<Value, bool>) {
      write(static_cast<std::uint8_t>(value));
    } else if constexpr (std::is_enum_v<Value>) {
      write(static_cast<std::uint8_t>(value));
    } else if constexpr (kIsOptional<Value>) {
      write(value.has_value());
      if (value) write(*value);
    } else if constexpr (kIsArray<Value>) {
      for (const auto& element : value) write(element);
    } else if constexpr (kIsVector<Value> || std::is_same_v<Value, std::string>) {
      write(static_cast<std::uint64_t>(value.size()));
      if constexpr (is_plain<typename Value::value_type>())
        append(value.data(), value.size() * sizeof(typename Value::value_type));
      else
        for (const auto& element : value) write(element);
    } else {
      std::apply([&](auto... members) { (write(value.*members), ...); }, kMembers<Value>);
    }
  }
  [[nodiscard]] nb::bytes bytes() const { return nb::bytes(bytes_.data(), bytes_.size()); }

 private:
  void append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

  std::string bytes_;
};

/// Throws sdm::Error for bytes that are too short, or no value.
class ValueReader {
 public:
  explicit ValueReader(const nb::bytes& bytes) : next_(bytes.c_str()), left_(bytes.size()) {}

  template <class Value>
  void read(Value& value) {
    if constexpr (is_plain<Value>()) {
      take(&value, sizeof(Value));
    } else if constexpr (std::is_same_v<Value, bool>) {
      value = below(2) != 0;
    } else if constexpr (std::is_enum_v<Value>) {
      value = static_cast<Value>(below(static_cast<std::size_t>(kLast<Value>) + 1));
    } else if constexpr (kIsOptional<Value>) {
      value.reset();
      if (below(2) != 0) read(value.emplace());
    } else if constexpr (kIsArray<Value>) {
      for (auto& element : value) read(element);
    } else if constexpr (kIsVector<Value> || std::is_same_v<Value, std::string>) {
      read_elements(value);
    } else {
      std::apply([&](auto... members) { (read(value.*members), ...); }, kMembers<Value>);
    }
  }
  void end() const {
    if (left_ > 0) throw Error(kDamaged);
  }

 private:
  void take(void* to, std::size_t size) {
    if (size > left_) throw Error(kDamaged);
    if (size > 0) std::memcpy(to, next_, size);
    next_ += size;
    left_ -= size;
  }
  std::size_t below(std::size_t count) {
    std::uint8_t number = 0;
    read(number);
    if (number >= count) throw Error(kDamaged);
    return number;
  }
  template <class Values>
  void read_elements(Values& values) {
    constexpr bool plain = is_plain<typename Values::value_type>();
    std::uint64_t count = 0;
    read(count);
    // An element takes a byte at least, so that a wrong number is found before memory is allocated for it.
    if (count > left_ / (plain ? sizeof(typename Values::value_type) : 1)) throw Error(kDamaged);
    values.resize(count);
    if constexpr (plain)
      take(values.data(), count * sizeof(typename Values::value_type));
    else
      for (auto& element : values) read(element);
  }

  const char* next_;
  std::size_t left_;
};

}  // namespace detail

template <class Value>
nb::bytes bytes_of(const Value& value) {
  detail::ValueWriter writer;
  writer.write(value);
  return writer.bytes();
}

/// The value of bytes_of(). Throws sdm::Error for other bytes.
template <class Value>
Value value_of(nb::handle bytes) {
  const auto stored = nb::cast<nb::bytes>(bytes);
  detail::ValueReader reader(stored);
  Value value;
  reader.read(value);
  reader.end();
  return value;
}

/// Adds pickling by the members of an object. `check` throws sdm::Error for one that cannot be.
template <class Object, class Check>
void bind_value(Check check) {
  bind_state<Object>(
      1, [](const Object& self) { return nb::make_tuple(bytes_of(self)); },
      [check](Object* self, const nb::tuple& from) {
        auto value = value_of<Object>(from[0]);
        check(value);
        new (self) Object(std::move(value));
      });
}
template <class Object>
void bind_value() {
  bind_value<Object>([](const Object&) {});
}

// What several objects consist of.
template <>
inline constexpr auto kMembers<Transform> = std::tuple{&Transform::rows};
template <>
inline constexpr auto kMembers<Mesh> = std::tuple{&Mesh::positions, &Mesh::triangles, &Mesh::corner_uvs};
template <>
inline constexpr auto kMembers<GivenOption> = std::tuple{&GivenOption::name, &GivenOption::value};
template <>
inline constexpr auto kMembers<MeasuredDistance> = std::tuple{
    &MeasuredDistance::kind, &MeasuredDistance::text, &MeasuredDistance::facing, &MeasuredDistance::settings};

}  // namespace sdm::python
