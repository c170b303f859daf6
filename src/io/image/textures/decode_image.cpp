#include <fmt/format.h>
#include <sdm/bake_files.h>
#include <sdm/error.h>
#include <sdm/mesh_attributes.h>

#include <algorithm>
#include <mutex>
#include <new>
#include <string_view>

#include "core/memory.h"
#include "io/file/error_prefix.h"
#include "io/file/file_bytes.h"
#include "io/image/textures/decoders.h"

namespace sdm {

namespace io {

namespace {

std::mutex memory_mutex;
std::size_t promised_memory = 0;

// The mutex must be locked.
void require_picture_memory(std::size_t bytes) {
  try {
    require_memory(bytes + promised_memory, "a picture");
  } catch (const Error& fault) {
    throw PictureTooLarge(fault.what());
  }
}

}  // namespace

PromisedMemory::PromisedMemory(std::size_t bytes) : bytes_(bytes) {
  const std::scoped_lock lock(memory_mutex);
  require_picture_memory(bytes);
  promised_memory += bytes;
}

void PromisedMemory::release() {
  const std::scoped_lock lock(memory_mutex);
  promised_memory -= bytes_;
  bytes_ = 0;
}

std::size_t check_size(std::size_t width, std::size_t height) {
  constexpr std::size_t kMostPixels = std::size_t{1} << 28, kMostOfASide = 100'000;
  if (width == 0 || height == 0) throw Error("the picture has no pixels");
  if (width > kMostOfASide || height > kMostOfASide)
    throw Error(fmt::format("the picture has {} × {} pixels, more than 100000 a side", width, height));
  if (width > kMostPixels / height)
    throw Error(fmt::format("the picture has {} × {} pixels, more than 2^28", width, height));
  return width * height;
}

Image blank_image(std::size_t width, std::size_t height, std::uint32_t components, std::uint32_t bits) {
  check_size(width, height);
  const std::size_t size = width * height * components * (bits / 8);
  // Its pages are taken before another picture is looked at.
  const std::scoped_lock lock(memory_mutex);
  require_picture_memory(size);
  return {.width = static_cast<std::uint32_t>(width),
          .height = static_cast<std::uint32_t>(height),
          .components = components,
          .bits = bits,
          .bytes = std::vector<std::uint8_t>(size)};
}

// Calls one of the functions of a format, or throws.
template <class Png, class Jpeg, class Webp>
auto by_format(std::span<const char> bytes, const Png& png, const Jpeg& jpeg, const Webp& webp) {
  const std::string_view start(bytes.data(), std::min<std::size_t>(bytes.size(), 16));
  if (start.starts_with("\x89PNG\r\n\x1A\n")) return png(bytes);
  if (start.starts_with("\xFF\xD8\xFF")) return jpeg(bytes);
  if (start.starts_with("RIFF") && start.substr(std::min<std::size_t>(start.size(), 8)).starts_with("WEBP"))
    return webp(bytes);
  throw Error("the picture is not PNG, JPEG or WebP");
}

std::size_t pixels_of(std::span<const char> bytes) {
  try {
    return by_format(bytes, pixels_of_png, pixels_of_jpeg, pixels_of_webp);
  } catch (const Error&) {
    return 0;
  }
}

}  // namespace io

Image decode_image(std::span<const char> bytes) try {
  return io::by_format(bytes, io::decode_png, io::decode_jpeg, io::decode_webp);
} catch (const std::bad_alloc&) {
  throw io::PictureTooLarge(out_of_memory("a picture").what());
}

Image read_image(const std::filesystem::path& file) {
  return io::with_error_prefix(file.string(), [&] { return decode_image(io::read_bytes(file).view()); });
}

}  // namespace sdm
