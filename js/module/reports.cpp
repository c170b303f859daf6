// Summaries of maps, and report.html.
#include <sdm/engine.h>
#include <sdm/error.h>
#include <sdm/map_files.h>
#include <sdm/measure.h>
#include <sdm/summary.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <variant>

#include "io/page/report/html_page.h"
#include "io/page/report/page_file.h"
#include "module/all_measures.h"
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

/// A map, what it was computed from and by, and what is asked of it.
struct Asked {
  const DistanceMap& map;
  const Surface& surface;
  const Sites& sites;
  GivenMeasure measure;
  Choices choices;
};

struct Reported {
  std::vector<float> at_vertices;
  std::string json;
};

/// Whether the sites are those of the mesh of the surface.
bool is_of_itself(DistanceKind kind) {
  return kind == DistanceKind::self || kind == DistanceKind::thickness;
}

/// The largest distance that a measure allows; infinite if it has no limit.
double max_distance_of(const Measure& measure) {
  return std::visit(
      [](const auto& options) {
        if constexpr (requires { options.max_distance; })
          return options.max_distance;
        else
          return std::numeric_limits<double>::infinity();
      },
      measure);
}

SummaryOptions summary_options(const Asked& asked, const Measure& measure, const std::string& units) {
  const Choices& choices = asked.choices;
  const Mesh& mesh = asked.surface.mesh();
  SummaryOptions options{
      .units = units,
      .max_distance = std::isnan(choices.max_distance) ? max_distance_of(measure) : choices.max_distance,
      .accuracy = asked.map.measured.kind == DistanceKind::thickness
                      ? thickness_accuracy(mesh)
                      : engine_accuracy(engines().front(), mesh, asked.sites.mesh()),
      .colormap = static_cast<Colormap>(choices.colormap),
      .progress = host_progress(),
  };
  if (!std::isnan(choices.lower)) options.tolerance = Tolerance{choices.lower, choices.upper};
  if (!std::isnan(choices.color_lo)) options.range = {choices.color_lo, choices.color_hi};
  return options;
}

/// The summary of a map by its measure; `at_vertices`: distances_at_vertices().
Summary summary_of(const Asked& asked, std::span<const float> at_vertices, const SummaryOptions& options) {
  switch (asked.map.measured.kind) {
    case DistanceKind::thickness:
      return summarize_thickness(asked.surface, asked.map, options);
    case DistanceKind::self:
      if (options.tolerance)
        throw Error(
            "the distances of a surface to itself jump between faces, so that texels do not bound them");
      return summarize_self(asked.surface, asked.map, options);
    default:
      return summarize(asked.surface, asked.sites, asked.map, at_vertices, options);
  }
}

Reported report_of(const Asked& asked) {
  const Choices& choices = asked.choices;
  const auto words = nlohmann::json::parse(std::string_view(choices.words, choices.words_size));
  const std::string units = words.at("units");
  Reported result;
  Summary summary;
  with_measure(asked.surface.mesh(), asked.measure, [&](const Measure& measure) {
    result.at_vertices = distances_at_vertices(asked.surface.mesh(), asked.sites, measure);
    summary = summary_of(asked, result.at_vertices, summary_options(asked, measure, units));
  });
  const auto mesh = [&](const Mesh& of, std::size_t i) {
    return ReportedMesh{.file = words.at("names").at(i), .info = inspect(of), .xxh3 = words.at("xxh3").at(i)};
  };
  result.json = report_json({.on = mesh(asked.surface.mesh(), 0),
                             .to = mesh(asked.sites.mesh(), 1),
                             .engine = std::string(engines().front().name)},
                            asked.surface, summary);
  return result;
}

/// A page whose arrays JavaScript compresses.
struct Draft {
  io::HtmlPage page;
  std::string report;
};

}  // namespace

SDM_EXPORT(sdm_map_summary)
Result* map_summary(const DistanceMap* map, const Surface* surface, const Sites* sites, const char* lines,
                    std::uint32_t bytes, const double* numbers, const double* rest, std::uint32_t vertices,
                    double lower, double upper, double color_lo, double color_hi, double max_distance,
                    std::uint32_t colormap, std::uint32_t up, const char* words, std::uint32_t words_size) {
  return guarded([&](Result& result) {
    result.put_text(
        "json", report_of({*map,
                           *surface,
                           *sites,
                           {{lines, bytes, numbers}, points(rest, vertices)},
                           {lower, upper, color_lo, color_hi, max_distance, colormap, up, words, words_size}})
                    .json);
  });
}

/// The draft, the lengths of the planes of its arrays, and these planes.
SDM_EXPORT(sdm_new_report)
Result* new_report(const DistanceMap* map, const Surface* surface, const Sites* sites, const char* lines,
                   std::uint32_t bytes, const double* numbers, const double* rest, std::uint32_t vertices,
                   double lower, double upper, double color_lo, double color_hi, double max_distance,
                   std::uint32_t colormap, std::uint32_t up, const char* words, std::uint32_t words_size) {
  return guarded([&](Result& result) {
    auto [at_vertices, json] =
        report_of({*map,
                   *surface,
                   *sites,
                   {{lines, bytes, numbers}, points(rest, vertices)},
                   {lower, upper, color_lo, color_hi, max_distance, colormap, up, words, words_size}});
    const bool of_itself = is_of_itself(map->measured.kind);
    auto draft = std::make_unique<Draft>(
        Draft{.page = io::html_page(*surface, *map, at_vertices,
                                    {.other = of_itself ? nullptr : &sites->mesh(),
                                     .up = up == 1 ? UpAxis::z : UpAxis::y,
                                     .places = of_itself ? ListedPlaces::least : ListedPlaces::deviating}),
              .report = std::move(json)});
    std::vector<std::uint32_t> lengths;
    std::vector<std::uint8_t> planes;
    for (const auto& plane : draft->page.arrays.planes()) {
      lengths.push_back(static_cast<std::uint32_t>(plane.size()));
      planes.insert(planes.end(), plane.begin(), plane.end());
    }
    result.put_object(std::move(draft));
    result.put("lengths", std::move(lengths));
    result.put("planes", std::move(planes));
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
    result.put_text("html", std::move(out).str());
  });
}

}  // namespace sdm::js
