#include "io/image/pictures/picture.h"

#include <algorithm>

#include "io/file/atomic_file.h"
#include "io/image/pictures/png.h"

namespace sdm::io {

void write_picture(const std::filesystem::path& file, const Picture& picture) {
  AtomicFile out(file);
  write_png(out.stream(), picture.width, picture.height, [&](std::uint32_t y, std::span<Rgb> pixels) {
    std::copy_n(&picture.pixels[std::size_t{y} * picture.width], picture.width, pixels.begin());
  });
  out.commit();
}

}  // namespace sdm::io
