#include <sdm/bake_files.h>
#include <sdm/error.h>
#include <sdm/map_files.h>
#include <sdm/points.h>

#include "io/page/player/player_page.h"

namespace sdm {
namespace {

[[noreturn]] void throw_without_page(const std::filesystem::path& file) {
  throw Error("cannot write " + file.string() +
              ": this sdm was built without the page; build it with -DSDM_BUILD_REPORT=ON");
}

}  // namespace

bool can_write_html() {
  return false;
}

void write_html(const std::filesystem::path& file, const Surface&, const DistanceMap&, std::span<const float>,
                const std::string&, const HtmlOptions&) {
  throw_without_page(file);
}

void write_points_html(const std::filesystem::path& file, const std::filesystem::path&, const PointDistances&,
                       const std::string&, const HtmlOptions&) {
  throw_without_page(file);
}

void write_baked_html(const std::filesystem::path& file, const Surface&, std::span<const BakedTexture>,
                      const BakedModelOptions&, const DetailedView&, const std::string&) {
  throw_without_page(file);
}

DetailedView::DetailedView(const BakedFrom&, const Mesh&) {
  throw_without_page("a page");
}

void io::write_player_page(const std::filesystem::path& file, const PlayerContent&, const PlayerOptions&,
                           const PictureOptions&) {
  throw_without_page(file);
}

}  // namespace sdm
