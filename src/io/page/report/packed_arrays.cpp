#include "io/page/report/packed_arrays.h"

#include <sdm/types.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/parallel.h"
#include "io/file/deflate.h"

namespace sdm::io {
namespace {

constexpr std::size_t kPlanes = 4;

std::vector<std::uint8_t> plane(std::span<const std::uint32_t> numbers, std::size_t which) {
  std::vector<std::uint8_t> bytes(numbers.size());
  std::uint8_t any = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    any |= bytes[i] = static_cast<std::uint8_t>(numbers[i] >> (8 * which));
  if (any == 0) bytes.clear();
  return bytes;
}

}  // namespace

void PackedArrays::add(std::string_view name, std::vector<std::uint32_t> numbers) {
  arrays_.push_back({std::string(name), std::move(numbers)});
}

void PackedArrays::add_differences(std::string_view name, std::span<const std::uint32_t> numbers,
                                   std::size_t stride) {
  std::vector<std::uint32_t> differences(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
    differences[i] = zigzag(numbers[i] - (i < stride ? 0 : numbers[i - stride]));
  add(name, std::move(differences));
}

void PackedArrays::add_guessed(std::string_view name, std::span<const std::uint32_t> numbers,
                               std::size_t stride, std::span<const std::array<std::uint32_t, 3>> guesses) {
  std::vector<std::uint32_t> differences(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto& [a, b, c] = guesses[i / stride];
    const auto at = [&](std::size_t vertex) { return numbers[vertex * stride + i % stride]; };
    differences[i] = zigzag(numbers[i] - (a == kNone ? 0 : at(a) + at(b) - at(c)));
  }
  add(name, std::move(differences));
}

void PackedArrays::add(PackedArrays&& other) {
  std::ranges::move(other.arrays_, std::back_inserter(arrays_));
}

std::vector<std::vector<std::uint8_t>> PackedArrays::planes() const {
  std::vector<std::vector<std::uint8_t>> planes(kPlanes * arrays_.size());
  parallel_for(planes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) planes[i] = plane(arrays_[i / kPlanes].numbers, i % kPlanes);
  });
  return planes;
}

void PackedArrays::set_compressed(std::span<const std::vector<std::uint8_t>> planes) {
  std::vector<std::uint8_t> all;
  for (std::size_t a = 0; a < arrays_.size(); ++a) {
    nlohmann::ordered_json& entry = index_[arrays_[a].name];
    entry["count"] = arrays_[a].numbers.size();
    for (std::size_t k = 0; k < kPlanes; ++k) {
      const std::vector<std::uint8_t>& bytes = planes[a * kPlanes + k];
      entry["bytes"].push_back(bytes.size());
      all.insert(all.end(), bytes.begin(), bytes.end());
    }
  }
  text_ = base85(all);
}

std::string base85(std::span<const std::uint8_t> bytes) {
  std::string text((bytes.size() + 3) / 4 * 5, '#');
  char* to = text.data();
  for (std::size_t i = 0; i < bytes.size(); i += 4, to += 5) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 4; ++k) group = group << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    for (int digit = 4; digit >= 0; --digit, group /= 85) {
      const std::uint32_t c = '#' + group % 85;
      to[digit] = static_cast<char>(c < '<' ? c : c + 1);
    }
  }
  return text;
}

void compress(PackedArrays& arrays) {
  std::vector<std::vector<std::uint8_t>> planes = arrays.planes();
  parallel_for(planes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!planes[i].empty()) planes[i] = deflate_part(planes[i], true);
  });
  arrays.set_compressed(planes);
}

}  // namespace sdm::io
