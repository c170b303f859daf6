// Summaries of maps, and report.html.
#include "module/reports.h"

#include <sdm/engine.h>
#include <sdm/error.h>
#include <sdm/map_files.h>
#include <sdm/measure.h>
#include <sdm/summary.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "io/page/report/html_page.h"
#include "io/page/report/page_file.h"
#include "module/all_measures.h"
#include "module/arguments.h"
#include "module/result.h"

namespace sdm::js {
namespace {

/// A map, what it was computed from and by, and what is asked of it.
struct Asked {
  const DistanceMap& map;
  const Surface& surface;
  const Sites& sites;
  GivenMeasure measure;
  SummaryOptions options;
  std::optional<double> max_distance;
  std::string_view files;  ///< JSON: the names of the files of both meshes, and their XXH3
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
          return kInfinity;
      },
      measure);
}

SummaryOptions summary_options(const Asked& asked, const Measure& measure) {
  const Mesh& mesh = asked.surface.mesh();
  SummaryOptions options = asked.options;
  options.max_distance = asked.max_distance.value_or(max_distance_of(measure));
  options.accuracy = asked.map.measured.kind == DistanceKind::thickness
                         ? thickness_accuracy(mesh)
                         : engine_accuracy(engines().front(), mesh, asked.sites.mesh());
  options.progress = host_progress();
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
  const auto files = nlohmann::json::parse(asked.files);
  Reported result;
  Summary summary;
  with_measure(asked.surface.mesh(), asked.measure, [&](const Measure& measure) {
    result.at_vertices = distances_at_vertices(asked.surface.mesh(), asked.sites, measure);
    summary = summary_of(asked, result.at_vertices, summary_options(asked, measure));
  });
  const auto mesh = [&](const Mesh& of, std::size_t i) {
    return ReportedMesh{.file = files.at("names").at(i), .info = inspect(of), .xxh3 = files.at("xxh3").at(i)};
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
Result* map_summary(DistanceMap* map, const Surface* surface, const Sites* sites, const char* lines,
                    std::uint32_t bytes, const double* numbers, const double* rest, std::uint32_t vertices,
                    const char* asked_lines, std::uint32_t asked_bytes, const double* asked_numbers,
                    const char* files, std::uint32_t files_size) {
  return guarded([&](Result& result) {
    count_missing(*surface, *map);  // it may have been computed in ranges
    const auto [options, limit] =
        read_all_options<SummaryOptions, MapLimit>({asked_lines, asked_bytes, asked_numbers});
    const Asked asked{*map,
                      *surface,
                      *sites,
                      {{lines, bytes, numbers}, points(rest, vertices)},
                      options,
                      limit.max_distance,
                      {files, files_size}};
    result.put_text("json", report_of(asked).json);
  });
}

/// The draft, the lengths of the planes of its arrays, and these planes.
SDM_EXPORT(sdm_new_report)
Result* new_report(DistanceMap* map, const Surface* surface, const Sites* sites, const char* lines,
                   std::uint32_t bytes, const double* numbers, const double* rest, std::uint32_t vertices,
                   const char* asked_lines, std::uint32_t asked_bytes, const double* asked_numbers,
                   const char* files, std::uint32_t files_size) {
  return guarded([&](Result& result) {
    count_missing(*surface, *map);  // it may have been computed in ranges
    const auto [options, limit, page] =
        read_all_options<SummaryOptions, MapLimit, PageOptions>({asked_lines, asked_bytes, asked_numbers});
    auto [at_vertices, json] = report_of({*map,
                                          *surface,
                                          *sites,
                                          {{lines, bytes, numbers}, points(rest, vertices)},
                                          options,
                                          limit.max_distance,
                                          {files, files_size}});
    const bool of_itself = is_of_itself(map->measured.kind);
    auto draft = std::make_unique<Draft>(
        Draft{.page = io::html_page(*surface, *map, at_vertices,
                                    {.other = of_itself ? nullptr : &sites->mesh(),
                                     .up = page.up,
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
