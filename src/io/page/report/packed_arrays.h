// Arrays of numbers in a form that compresses well, as text.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sdm::io {

/// Arrays of 32-bit numbers, each split into four planes of bytes: the low ones of all numbers, the next
/// ones, and so on. Planes are compressed by themselves. report/src/arrays.ts unpacks them.
// NOLINTNEXTLINE(bugprone-exception-escape): moving JSON does not throw
class PackedArrays {
 public:
  /// Adds numbers as they are.
  void add(std::string_view name, std::vector<std::uint32_t> numbers);
  /// Adds the differences of numbers that are small if neighbours are close: number i minus number i − stride
  /// (0 before the first), as an unsigned number whose last bit is the sign.
  void add_differences(std::string_view name, std::span<const std::uint32_t> numbers, std::size_t stride = 1);

  /// Adds the arrays of another object.
  void add(PackedArrays&& other);

  /// Compresses all planes. Cost: linear, all cores.
  void compress();
  /// The `count` of each array and the lengths of its four compressed planes, `bytes`, 0 for a plane of
  /// zeros; planes follow each other in the order of the arrays. After compress().
  [[nodiscard]] const nlohmann::ordered_json& index() const { return index_; }
  /// The planes in base64. After compress().
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  struct Array {
    std::string name;
    std::vector<std::uint32_t> numbers;
  };
  std::vector<Array> arrays_;
  nlohmann::ordered_json index_;
  std::string text_;
};

/// `x` for a difference of −1, 1, −2, 2, …: 1, 2, 3, 4, …; 0 for 0.
[[nodiscard]] constexpr std::uint32_t zigzag(std::uint32_t difference) {
  return (difference << 1) ^ (difference >> 31 ? 0xFFFFFFFFu : 0u);
}

[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace sdm::io
