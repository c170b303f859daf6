#include <sdm/error.h>
#include <sdm/io.h>

namespace sdm {

bool can_write_html() {
  return false;
}

void write_html(const std::filesystem::path& file, const Surface&, const DistanceMap&, std::span<const float>,
                const std::string&, const HtmlOptions&) {
  throw Error("cannot write " + file.string() +
              ": this sdm was built without the page; build it with -DSDM_BUILD_REPORT=ON");
}

}  // namespace sdm
