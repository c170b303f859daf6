#include <sdm/error.h>
#include <sdm/map_files.h>

#include <new>
#include <string>

#include "core/memory.h"
#include "io/file/atomic_file.h"
#include "io/page/report/embedded_page.h"
#include "io/page/report/html_page.h"
#include "io/page/report/packed_arrays.h"
#include "io/page/report/page_file.h"

namespace sdm {
namespace {

io::HtmlPage page_of(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
                     std::span<const float> vertex_distances, const HtmlOptions& options) try {
  return io::html_page(surface, map, vertex_distances, options);
} catch (const Cancelled&) {
  throw;
} catch (const Error& fault) {
  throw Error("cannot write " + file.string() + ": " + fault.what());
}

}  // namespace

bool can_write_html() {
  return true;
}

void write_html(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
                std::span<const float> vertex_distances, const std::string& report,
                const HtmlOptions& options) try {
  io::AtomicFile out(file);
  io::HtmlPage made = page_of(file, surface, map, vertex_distances, options);
  io::compress(made.arrays);
  io::put_page(out.stream(), io::kPageHtml.bytes, made.page, &report, made.arrays);
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
