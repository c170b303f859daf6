#include <sdm/bake_files.h>
#include <sdm/error.h>
#include <sdm/mesh_attributes.h>

#include <new>
#include <sstream>

#include "core/memory.h"
#include "io/image/pictures/png.h"

namespace sdm {

std::vector<char> encode_png(const Image& image, bool srgb) try {
  const std::size_t bytes =
      std::size_t{image.width} * image.height * image.components * (image.bits == 16 ? 2 : 1);
  if (bytes == 0 || image.components > 4 || (image.bits != 8 && image.bits != 16) ||
      image.bytes.size() != bytes)
    throw Error("cannot encode a picture: its bytes are not those of its pixels");
  std::ostringstream stream;
  io::write_image_png(stream, image, srgb);
  const std::string_view text = stream.view();
  return {text.begin(), text.end()};
} catch (const std::bad_alloc&) {
  throw out_of_memory("a PNG file");
}

}  // namespace sdm
