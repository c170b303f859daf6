// Section 4.1: hits of the stencil cache against the number of stencil values.
#include <fmt/format.h>

#include <set>

#include "gl/raster_report.h"
#include "gl/stencil_cache.h"
#include "research/figures/charts/chart.h"
#include "research/figures/figures.h"
#include "research/figures/pieces.h"
#include "research/figures/site_pairs.h"
#include "research/figures/timing.h"

namespace sdm::figures {
namespace {

const std::vector<int> kValues{1, 2, 4, 8, 16, 32, 64, 128, 255};

struct Curve {
  std::vector<double> values, hits;  ///< percentages of lookups
  std::vector<Times> times;          ///< of the engine's maps
  std::uint64_t lookups = 0;

  [[nodiscard]] Json json() const {
    Json result{{"stencil_values", values}, {"hit_percent", hits}, {"lookups", lookups}};
    if (times.empty()) return result;
    result["map_ms"] = Json::array();
    for (const Times& t : times) result["map_ms"].push_back(to_json(t));
    return result;
  }
};

/// The cache in the engine, which sorts the polygons of a batch by face.
Curve in_engine(Run& run, const Surface& surface, const Sites& sites) {
  Curve curve;
  for (const int values : kValues) {
    run.step("stencil");
    const auto engine = make_gl_engine({.clip = GlClip::stencil, .stencil_values = values});
    DistanceMap map;
    curve.times.push_back(
        repeat([&] { compute_map(surface, sites, {.engine = engine, .sign = SignMethod::none}, map); },
               run.choose(3, 1)));
    const gl::RasterReport r = gl::raster_report(*engine).value();
    curve.values.push_back(values);
    curve.hits.push_back(100 * static_cast<double>(r.stencil_hits) / static_cast<double>(r.stencil_lookups));
    curve.lookups = r.stencil_lookups;
  }
  return curve;
}

/// The cache in the order of Algorithm 1.
Curve in_order(const DrawOrder& faces) {
  Curve curve;
  for (const int values : kValues) {
    gl::StencilCache cache(values);
    for (const std::uint32_t face : faces) cache.use(face);
    curve.values.push_back(values);
    curve.hits.push_back(100 * static_cast<double>(cache.hits()) / static_cast<double>(cache.lookups()));
    curve.lookups = cache.lookups();
  }
  return curve;
}

/// The percentage of lookups that hit with a value for each face.
double most_hits(const DrawOrder& faces) {
  const std::set<std::uint32_t> different(faces.begin(), faces.end());
  return 100 * (1 - static_cast<double>(different.size()) / static_cast<double>(faces.size()));
}

/// A body's map, its draw orders and hits.
struct Case {
  std::string key, name;
  Surface surface;
  Sites sites;
  Curve all{}, winning{}, engine{};
  double most_all = 0, most_winning = 0;

  Case(std::string its_key, std::string its_name, const Mesh& o1, const Mesh& o2, std::uint32_t resolution)
      : key(std::move(its_key)),
        name(std::move(its_name)),
        surface(o1, {.resolution = resolution}),
        sites(o2) {
    const DrawOrder pairs = intersecting_pairs(surface, sites), winners = winning_pairs(surface, sites);
    all = in_order(pairs);
    winning = in_order(winners);
    most_all = most_hits(pairs);
    most_winning = most_hits(winners);
  }
};

Series series(const std::string& name, const Curve& curve) {
  return {.name = name, .x = curve.values, .y = curve.hits};
}

}  // namespace

Figure stencil(Run& run) {
  const std::uint32_t resolution = run.choose(256u, 128u);
  const auto [e, g] = run.letters().meshes(0);
  const scenes::Scene scene(scenes::SceneKind::figure);
  const Mesh &figure_mesh = scene.bodies()[0].mesh, &box_mesh = scene.bodies()[1].mesh;
  std::vector<Case> cases;
  cases.emplace_back("letter", "letter E", e, g, resolution);
  cases.emplace_back("box", "box", box_mesh, figure_mesh, resolution);

  Chart chart{.title = "Hits of the stencil cache",
              .x = {.label = "stencil values", .log = true},
              .y = {.label = "hits (% of lookups)"}};
  Json measured{{"resolution", resolution}};
  std::vector<std::string> heads{"values"};
  std::vector<std::vector<std::string>> rows;
  rows.reserve(kValues.size());
  for (const int values : kValues) rows.push_back({fmt::to_string(values)});
  const auto column = [&](const std::string& head, const std::vector<double>& hits) {
    heads.push_back(head);
    for (std::size_t i = 0; i < hits.size(); ++i) rows[i].push_back(fmt::format("{:.1f} %", hits[i]));
  };
  for (Case& c : cases) {
    if (run.gl) c.engine = in_engine(run, c.surface, c.sites);
    chart.series.push_back(series(c.name + ", all pairs", c.all));
    chart.series.push_back(series(c.name + ", winning pairs", c.winning));
    column(c.name + ", all pairs", c.all.hits);
    column("winning pairs", c.winning.hits);
    measured[c.key] = {
        {"faces", c.surface.mesh().triangles.size()},   {"all_pairs", c.all.json()},
        {"most_hits_of_all_pairs", c.most_all},         {"winning_pairs", c.winning.json()},
        {"most_hits_of_winning_pairs", c.most_winning}, {"engine", run.gl ? c.engine.json() : Json(nullptr)}};
    if (!run.gl) continue;
    chart.series.push_back(series(c.name + ", gl engine", c.engine));
    column("engine", c.engine.hits);
    heads.emplace_back("time");
    for (std::size_t i = 0; i < kValues.size(); ++i)
      rows[i].push_back(fmt::format("{:.3g} ms", c.engine.times[i].median()));
  }
  const Case &letter = cases[0], &box = cases[1];
  const std::string by_engine = run.gl
                                    ? fmt::format(
                                          "The gl engine (on {}) sorts the polygons of a batch by face "
                                          "instead, so that a batch looks up each face once: {} lookups for "
                                          "the letter, {} for the box.",
                                          run.machine.gl_text(), letter.engine.lookups, box.engine.lookups)
                                    : "The gl engine itself was not measured: there is no OpenGL 4.5 device.";
  Figure figure{.key = "stencil",
                .title = "Section 4.1: the stencil cache",
                .paper =
                    "Triangles are clipped by stencil values that a cache assigns to them, with the least "
                    "recently used value reassigned. No hit rates are given.",
                .measured = fmt::format(
                    "Maps of {}²: the letter E ({} faces) to the letter G, and the box (12 faces) to its "
                    "figure. The cache was run in the order of Algorithm 1, site by site, with the sites in "
                    "the order of their tree. All pairs: each site whose region intersects the face (Lemma "
                    "1), {} lookups for the letter, of which {:.3g} % hit with 255 values and {:.3g} % with "
                    "a value for every face; for the box {:.3g} and {:.3g} %. Winning pairs: those that no "
                    "culling can avoid, {} lookups, {:.3g} and {:.3g} %; for the box {:.3g} and {:.3g} %. {}",
                    resolution, letter.surface.mesh().triangles.size(), letter.all.lookups,
                    letter.all.hits.back(), letter.most_all, box.all.hits.back(), box.most_all,
                    letter.winning.lookups, letter.winning.hits.back(), letter.most_winning,
                    box.winning.hits.back(), box.most_winning, by_engine)};
  figure.html = {panel(to_svg(chart), ""), table(heads, rows)};
  figure.json = {{"paper", Json::object()}, {"measured", measured}};
  return figure;
}

}  // namespace sdm::figures
