// Arrays as one block of bytes, of which loaded arrays are views.
//
// Both directions walk the same list: what is stored has a function
//   template <class Self, class Visit> static void for_each_member(Self& self, const Visit& visit),
// which calls visit(member) for an Array, a std::vector, a number, or something with such a function itself.
//
// The block: a header, a table of the sizes of the arrays, and each array at a multiple of 64 bytes. Its
// checksum is that of the checksums of its parts, so that all cores compute it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "core/arrays/array.h"

namespace sdm::core {

/// What blocks are recognised by.
struct StoredFormat {
  std::array<char, 8> magic;
  std::uint32_t version;
  const char* object;  ///< "shape", for messages
  const char* source;  ///< "mesh": what objects are built from
};

/// The bytes of a block in memory that may be changed, and that nothing else refers to, at a multiple of 64
/// bytes.
struct StoredBytes {
  std::span<std::byte> bytes;
  std::shared_ptr<const void> owner;
};

namespace stored {
template <class T>
inline constexpr bool kNumber = std::is_arithmetic_v<T>;
}

/// Lists what is to be stored.
class ArrayWriter {
 public:
  template <class T>
  void operator()(const Array<T>& items) {
    add(items.data(), items.size(), sizeof(T));
  }
  template <class T>
  void operator()(const std::vector<T>& items) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(items.data(), items.size(), sizeof(T));
  }
  template <class T>
  void operator()(const T& value) {
    if constexpr (stored::kNumber<T>)
      add(&value, 1, sizeof(T));
    else
      T::for_each_member(value, [this](const auto& member) { (*this)(member); });
  }

  /// Calls write(bytes) for one part of the block after the other. All that was listed must be unchanged.
  void write(const StoredFormat& format, const std::function<void(std::span<const std::byte>)>& write) const;

 private:
  struct Part {
    const void* data;
    std::uint64_t count;
    std::uint32_t item_size;
  };
  void add(const void* data, std::size_t count, std::size_t item_size);

  std::vector<Part> parts_;
};

/// Reads them in the same order.
class ArrayReader {
 public:
  /// Throws sdm::Error unless the bytes are a complete block of this format and version without damage. Cost:
  /// linear, all cores.
  ArrayReader(StoredBytes stored, const StoredFormat& format);

  /// Sets the array to a view. Throws sdm::Error if items of this size were not stored here.
  template <class T>
  void operator()(Array<T>& items) {
    const std::span<std::byte> bytes = take(sizeof(T));
    items = Array<T>({reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)}, stored_.owner);
  }
  /// Copies.
  template <class T>
  void operator()(std::vector<T>& items) {
    const std::span<std::byte> bytes = take(sizeof(T));
    items.resize(bytes.size() / sizeof(T));
    if (!items.empty()) std::memcpy(items.data(), bytes.data(), bytes.size());
  }
  template <class T>
  void operator()(T& value) {
    if constexpr (stored::kNumber<T>) {
      const std::span<std::byte> bytes = take(sizeof(T));
      if (bytes.size() != sizeof(T)) fail();
      if constexpr (std::is_same_v<T, bool>) {
        if (std::to_integer<int>(bytes[0]) > 1) fail();
        value = std::to_integer<int>(bytes[0]) == 1;
      } else {
        std::memcpy(&value, bytes.data(), sizeof(T));
      }
    } else {
      T::for_each_member(value, [this](auto& member) { (*this)(member); });
    }
  }

  /// Throws sdm::Error unless all has been read.
  void finish() const;
  /// Throws sdm::Error: the contents contradict each other.
  [[noreturn]] void fail() const;

 private:
  struct Entry {
    std::uint64_t count;
    std::uint64_t item_size;
  };
  std::span<std::byte> take(std::size_t item_size);

  StoredBytes stored_;
  StoredFormat format_;
  std::span<const Entry> table_;
  std::size_t next_ = 0, offset_ = 0;

  friend class ArrayWriter;
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
