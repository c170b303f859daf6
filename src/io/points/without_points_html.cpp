#include <sdm/error.h>
#include <sdm/points.h>

namespace sdm {

void write_points_html(const std::filesystem::path& file, const std::filesystem::path&, const PointDistances&,
                       const std::string&, const HtmlOptions&) {
  throw Error("cannot write " + file.string() +
              ": this sdm was built without the page; build it with -DSDM_BUILD_REPORT=ON");
}

}  // namespace sdm
