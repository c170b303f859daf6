#include "support/same_contents.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStdIO.h>
#include <png.h>

#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sdm::test {
namespace {

using Values = std::vector<char>;

/// Width, height and samples.
std::pair<std::pair<png_uint_32, png_uint_32>, Values> pixels_of_png(const std::string& text) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  Values pixels;
  bool read = png_image_begin_read_from_memory(&image, text.data(), text.size()) != 0;
  if (read) {
    pixels.resize(PNG_IMAGE_SIZE(image));
    read = png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr) != 0;
  }
  if (!read) throw std::runtime_error(image.message);
  return {{image.width, image.height}, pixels};
}

/// The values of each channel.
std::map<std::string, Values> channels_of_exr(const std::string& text) {
  Imf::StdISStream stream;
  stream.str(text);
  Imf::InputFile exr(stream);
  const auto window = exr.header().dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1),
             height = static_cast<std::size_t>(window.max.y - window.min.y + 1);
  std::map<std::string, Values> channels;
  Imf::FrameBuffer frame;
  for (auto it = exr.header().channels().begin(); it != exr.header().channels().end(); ++it) {
    const std::size_t size = it.channel().type == Imf::HALF ? 2 : 4;
    Values& values = channels[it.name()];
    values.resize(width * height * size);
    const auto first = static_cast<std::ptrdiff_t>(size) *
                       (window.min.x + window.min.y * static_cast<std::ptrdiff_t>(width));
    frame.insert(it.name(), Imf::Slice(it.channel().type, values.data() - first, size, width * size));
  }
  exr.setFrameBuffer(frame);
  exr.readPixels(window.min.y, window.max.y);
  return channels;
}

}  // namespace

bool same_contents(const std::string& name, const std::string& text, const std::string& other) {
  if (text == other) return true;
  if (name.ends_with(".png")) return pixels_of_png(text) == pixels_of_png(other);
  if (name.ends_with(".exr")) return channels_of_exr(text) == channels_of_exr(other);
  return false;
}

}  // namespace sdm::test
