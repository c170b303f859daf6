// Summaries of maps, and report.html.
#include <sdm/engine.h>
#include <sdm/error.h>
#include <sdm/io.h>
#include <sdm/report.h>
#include <sdm/summary.h>
#include <sdm/vertex_distances.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>

#include "io/page/report/html_page.h"
#include "io/page/report/page_file.h"
#include "module/arguments.h"
#include "module/result.h"

namespace sdm::js {
namespace {

/// What JavaScript passes: limits of the tolerance and of the colours, NaN for none, and words as JSON.
struct Choices {
  double lower, upper, color_lo, color_hi, max_distance;
  std::uint32_t colormap, up;
  const char* words;
  std::uint32_t words_size;
};

struct Reported {
  std::vector<float> at_vertices;
  std::string json;
};

SummaryOptions summary_options(const Surface& surface, const Sites& sites, const Choices& choices,
                               const std::string& units) {
  SummaryOptions options{
      .units = units,
      .max_distance = choices.max_distance,
      .accuracy = engine_accuracy(engines().front(), surface.mesh(), sites.mesh()),
      .colormap = static_cast<Colormap>(choices.colormap),
      .progress = host_progress(),
  };
  if (!std::isnan(choices.lower)) options.tolerance = Tolerance{choices.lower, choices.upper};
  if (!std::isnan(choices.color_lo)) options.range = {choices.color_lo, choices.color_hi};
  return options;
}

Reported report_of(const DistanceMap& map, const Surface& surface, const Sites& sites,
                   const Choices& choices) {
  const auto words = nlohmann::json::parse(std::string_view(choices.words, choices.words_size));
  const std::string units = words.at("units");
  Reported result;
  result.at_vertices = distances_at_vertices(
      surface.mesh(), sites,
      {.sign = map.sign.method, .max_distance = choices.max_distance, .facing = map.measured.facing});
  const Summary summary =
      summarize(surface, sites, map, result.at_vertices, summary_options(surface, sites, choices, units));
  const auto mesh = [&](const Mesh& of, std::size_t i) {
    return ReportedMesh{.file = words.at("names").at(i), .info = inspect(of), .xxh3 = words.at("xxh3").at(i)};
  };
  result.json = report_json({.on = mesh(surface.mesh(), 0),
                             .to = mesh(sites.mesh(), 1),
                             .engine = std::string(engines().front().name)},
                            surface, summary);
  return result;
}

/// A page whose arrays JavaScript compresses.
struct Draft {
  io::HtmlPage page;
  std::string report;
};

}  // namespace

SDM_EXPORT(sdm_map_summary)
Result* map_summary(const DistanceMap* map, const Surface* surface, const Sites* sites, double lower,
                    double upper, double color_lo, double color_hi, double max_distance,
                    std::uint32_t colormap, std::uint32_t up, const char* words, std::uint32_t words_size) {
  return guarded([&](Result& result) {
    result.add_text(
        report_of(*map, *surface, *sites,
                  {lower, upper, color_lo, color_hi, max_distance, colormap, up, words, words_size})
            .json);
  });
}

/// The draft, the lengths of the planes of its arrays, and these planes.
SDM_EXPORT(sdm_new_report)
Result* new_report(const DistanceMap* map, const Surface* surface, const Sites* sites, double lower,
                   double upper, double color_lo, double color_hi, double max_distance,
                   std::uint32_t colormap, std::uint32_t up, const char* words, std::uint32_t words_size) {
  return guarded([&](Result& result) {
    auto [at_vertices, json] =
        report_of(*map, *surface, *sites,
                  {lower, upper, color_lo, color_hi, max_distance, colormap, up, words, words_size});
    auto draft = std::make_unique<Draft>(
        Draft{.page = io::html_page(*surface, *map, at_vertices,
                                    {.other = &sites->mesh(), .up = up == 1 ? UpAxis::z : UpAxis::y}),
              .report = std::move(json)});
    std::vector<std::uint32_t> lengths;
    std::vector<std::uint8_t> planes;
    for (const auto& plane : draft->page.arrays.planes()) {
      lengths.push_back(static_cast<std::uint32_t>(plane.size()));
      planes.insert(planes.end(), plane.begin(), plane.end());
    }
    result.add_object(std::move(draft));
    result.add(std::move(lengths));
    result.add(std::move(planes));
  });
}

SDM_EXPORT(sdm_free_report) void free_report(Draft* draft) {
  delete draft;
}

/// The text of the page `html` with the data of the draft, whose planes are compressed.
SDM_EXPORT(sdm_finish_report)
Result* finish_report(Draft* draft, const std::uint8_t* planes, const std::uint32_t* lengths,
                      std::uint32_t count, const char* html, std::uint32_t html_size) {
  return guarded([&](Result& result) {
    std::vector<std::vector<std::uint8_t>> compressed;
    for (std::uint32_t i = 0; i < count; planes += lengths[i++])
      compressed.emplace_back(planes, planes + lengths[i]);
    draft->page.arrays.set_compressed(compressed);
    std::ostringstream out;
    io::put_page(out, {html, html_size}, draft->page.page, &draft->report, draft->page.arrays);
    result.add_text(out.view());
  });
}

}  // namespace sdm::js
