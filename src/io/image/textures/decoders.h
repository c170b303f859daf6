// One decoder for each format of pictures. All throw sdm::Error; the message does not name the file.
#pragma once

#include <sdm/error.h>
#include <sdm/mesh_attributes.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace sdm::io {

/// A picture that is not damaged, for which there is not enough memory.
class PictureTooLarge : public Error {
 public:
  using Error::Error;
};

/// Memory that a library takes later, while it decodes a picture. Pictures are decoded side by side, so that
/// each one counts what was promised to the others.
class PromisedMemory {
 public:
  /// Throws PictureTooLarge unless there is as much memory beside what is promised.
  explicit PromisedMemory(std::size_t bytes);
  ~PromisedMemory() { release(); }
  /// Once the library has taken it: then it is no longer among the free memory.
  void release();
  PromisedMemory(const PromisedMemory&) = delete;
  PromisedMemory& operator=(const PromisedMemory&) = delete;

 private:
  std::size_t bytes_;
};

/// The pixels that the start of a PNG, JPEG or WebP file says it has, at most those of check_size(); 0 where
/// it cannot be read, as decode_image() then says.
[[nodiscard]] std::size_t pixels_of(std::span<const char> bytes);
[[nodiscard]] std::size_t pixels_of_png(std::span<const char> bytes);
[[nodiscard]] std::size_t pixels_of_jpeg(std::span<const char> bytes);
[[nodiscard]] std::size_t pixels_of_webp(std::span<const char> bytes);

[[nodiscard]] Image decode_png(std::span<const char> bytes);
[[nodiscard]] Image decode_jpeg(std::span<const char> bytes);
[[nodiscard]] Image decode_webp(std::span<const char> bytes);

/// Returns the number of pixels. Throws sdm::Error for a picture without pixels, with more than 100,000 a
/// side, or more than 2^28.
std::size_t check_size(std::size_t width, std::size_t height);

/// A picture of this size, of which the bytes are to be set. Throws sdm::Error as check_size() does, and
/// PictureTooLarge.
[[nodiscard]] Image blank_image(std::size_t width, std::size_t height, std::uint32_t components,
                                std::uint32_t bits);

}  // namespace sdm::io
