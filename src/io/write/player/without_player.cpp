#include <sdm/error.h>

#include "io/write/player/player_page.h"

namespace sdm::io {

void write_player_page(const std::filesystem::path& file, const PlayerContent&, const PlayerOptions&,
                       const PictureOptions&) {
  throw Error("cannot write " + file.string() +
              ": this sdm was built without the page; build it with -DSDM_BUILD_REPORT=ON");
}

}  // namespace sdm::io
