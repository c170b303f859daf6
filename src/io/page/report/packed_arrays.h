// Arrays of numbers in a form that compresses well, as text.
#pragma once

#include <array>
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

  /// Adds what is left of numbers at vertices, `stride` each, after the guesses of guesses_of(), as
  /// differences.
  void add_guessed(std::string_view name, std::span<const std::uint32_t> numbers, std::size_t stride,
                   std::span<const std::array<std::uint32_t, 3>> guesses);

  /// Adds the arrays of another object.
  void add(PackedArrays&& other);

  /// The planes of all arrays, four each; a plane of zeros is empty. Cost: linear, all cores.
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> planes() const;
  /// Takes planes() with each that is not empty compressed, as a stream of deflate (compress_arrays.h).
  void set_compressed(std::span<const std::vector<std::uint8_t>> planes);
  /// The `count` of each array and the lengths of its four compressed planes, `bytes`, 0 for a plane of
  /// zeros; planes follow each other in the order of the arrays. After set_compressed().
  [[nodiscard]] const nlohmann::ordered_json& index() const { return index_; }
  /// The planes as text. After set_compressed().
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

/// Bytes as text, five characters for each four as digits to base 85, the first of the highest value: those
/// from # to x but <, with which an element of a page could end. The bytes of the last group are filled up
/// with zeros.
[[nodiscard]] std::string base85(std::span<const std::uint8_t> bytes);

/// Compresses the planes. Cost: linear, all cores.
void compress(PackedArrays& arrays);

}  // namespace sdm::io
