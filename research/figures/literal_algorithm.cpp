// Algorithm 1 as it is printed, beside the corrected one: what each correction contributes, and costs.
#include <fmt/format.h>
#include <sdm/closest_points.h>

#include <algorithm>
#include <span>

#include "gl/raster_report.h"
#include "research/figures/charts/bars.h"
#include "research/figures/corrections.h"
#include "research/figures/figures.h"
#include "research/figures/pieces.h"
#include "research/figures/timing.h"
#include "research/figures/view.h"
#include "research/literal/literal_engine.h"

namespace sdm::figures {
namespace {

struct Case {
  std::string key, name;
  Mesh o1, o2;
};

std::vector<Case> cases(Run& run) {
  const auto [left, right] = run.bunnies().meshes(0);
  const auto [e, g] = run.letters().meshes(0);
  const scenes::Scene scene(scenes::SceneKind::figure);
  std::vector<Case> result{{"bunnies", "one bunny to the other", left, right}};
  if (run.quick) return result;
  result.push_back({"letters", "letter E to letter G", e, g});
  result.push_back({"figure_to_box", "figure to box", scene.bodies()[0].mesh, scene.bodies()[1].mesh});
  return result;
}

/// A map with all corrections painted grey, and in red where `wrong` has the texel.
io::Picture wrong_in_red(const Surface& surface, const std::vector<std::uint32_t>& wrong, const View& view) {
  std::vector<bool> is_wrong(std::size_t{surface.resolution()} * surface.rows());
  for (const std::uint32_t t : wrong)
    if (t < is_wrong.size()) is_wrong[t] = true;
  const Shown shown{&surface};
  return Scenery(view, std::span(&shown, 1)).paint([&](const Seen& s) {
    return is_wrong[s.texel] ? io::Rgb{205, 30, 30} : io::Rgb{196, 200, 206};
  });
}

/// A variant of the algorithm on a case.
struct Result {
  std::string name{};
  MapErrors errors{};
  double repaired = 0;  ///< percentage of texels
  Times times{};
};

/// All corrections first, then the algorithm as printed.
std::vector<Result> measure(Run& run, const Surface& surface, const Sites& sites) {
  const auto map_by = [&](const std::shared_ptr<const Engine>& engine) {
    return compute_map(surface, sites, {.engine = engine, .sign = SignMethod::none});
  };
  const DistanceMap reference = map_by(make_engine("reference"));
  std::vector<Result> results;
  std::vector<std::function<void()>> work;
  for (const Variant& variant : added_corrections()) {
    run.step("literal_algorithm");
    const auto engine = literal::make_engine({}, variant.corrections);
    const MapErrors errors = errors_of(map_by(engine), reference, surface, sites);
    const gl::RasterReport report = literal::report(*engine).value();
    results.push_back({variant.name, errors,
                       100 * static_cast<double>(report.unconfirmed) / static_cast<double>(report.texels)});
    work.emplace_back([&map_by, engine] { (void)map_by(engine); });
  }
  const std::vector<Times> times = take_turns(work, run.choose(3, 1), false);
  for (std::size_t i = 0; i < times.size(); ++i) results[i].times = times[i];
  return results;
}

double relative_time(const Result& result, const std::vector<Result>& results) {
  return result.times.median() / results.front().times.median();
}

Json to_json(const std::vector<Result>& results) {
  Json json = Json::array();
  for (const Result& r : results)
    json.push_back({{"variant", r.name},
                    {"wrong_percent", r.errors.wrong},
                    {"none_percent", r.errors.none},
                    {"largest_error", r.errors.largest},
                    {"mean_error", r.errors.mean},
                    {"repaired_percent", r.repaired},
                    {"map_ms", to_json(r.times)}});
  return json;
}

std::string charts_and_table(const std::vector<Result>& results) {
  std::vector<Bar> wrong, time;
  std::vector<std::vector<std::string>> rows;
  for (const Result& r : results) {
    const double relative = relative_time(r, results);
    wrong.push_back({r.name, r.errors.wrong, fmt::format("{:.3g} %", r.errors.wrong)});
    time.push_back({r.name, relative, fmt::format("{:.2f}×", relative)});
    rows.push_back({r.name, fmt::format("{:.3g}", r.errors.wrong),
                    fmt::format("{:.3g}", 1e6 * r.errors.largest), fmt::format("{:.3g}", 1e6 * r.errors.mean),
                    fmt::format("{:.3g}", r.repaired), r.times.median_text(),
                    fmt::format("{:.2f}×", relative)});
  }
  return row({panel(bars("Wrong texels", wrong), ""),
              panel(bars("Time, relative to all corrections", time), "")}) +
         table({"variant", "wrong (%)", "largest error (ppm)", "mean error (ppm)", "repaired (%)", "time",
                "relative"},
               rows);
}

/// Signs by the orientation of the closest face, as 6.2 describes them, against the winding number.
struct Signs {
  std::size_t samples = 0, inside = 0, wrong = 0;
};

Signs compare_signs(const Recording& recording, std::uint32_t resolution) {
  Signs result;
  for (std::size_t frame = 0; frame < recording.frames.size(); frame += 5) {
    const auto meshes = recording.meshes(frame);
    for (int b = 0; b < 2; ++b) {
      const Surface surface(meshes[b], {.resolution = resolution});
      const Sites sites(meshes[1 - b]);
      const std::vector<Vec3> points = surface.sample_points();
      const std::vector<ClosestPoint> closest = closest_points(sites, points);
      const std::vector<std::uint8_t> inside = inside_flags(sites, points, closest, SignMethod::exact);
      const Mesh& mesh = sites.mesh();
      for (std::size_t i = 0; i < points.size(); ++i) {
        const auto& [x, y, z] = mesh.triangles[closest[i].face];
        const Vec3 normal =
            cross(mesh.positions[y] - mesh.positions[x], mesh.positions[z] - mesh.positions[x]);
        const bool behind = dot(points[i] - closest[i].point, normal) < 0;
        ++result.samples;
        result.inside += inside[i];
        result.wrong += behind != (inside[i] != 0);
      }
    }
  }
  return result;
}

}  // namespace

Figure literal_algorithm(Run& run) {
  const std::uint32_t resolution = run.choose(256u, 96u);
  Figure figure{
      .key = "literal_algorithm",
      .title = "Algorithm 1 as printed, and corrected",
      .paper =
          "Algorithm 1: the oriented box of each site's region is clipped to the plane of a face, and the "
          "distance vectors of the corners are interpolated. The result is stated to be exact at the samples "
          "(Lemma 1, 5.1). 6.2: signs by the orientation of the surface."};
  const Signs signs = compare_signs(run.letters(), run.choose(128u, 64u));
  Json measured{{"resolution", resolution},
                {"signs", {{"samples", signs.samples}, {"inside", signs.inside}, {"wrong", signs.wrong}}},
                {"cases", nullptr}};
  const std::string about_signs = fmt::format(
      " Signs by the orientation of the closest face are wrong at {} of {} samples of the letters, in every "
      "fifth frame, {} of which are inside; the comparison is with winding numbers.",
      signs.wrong, signs.samples, signs.inside);
  if (!run.gl) {
    figure.measured = "The maps were not measured: there is no OpenGL 4.5 device." + about_signs;
    figure.json = {{"paper", {{"error_at_samples", 0}}}, {"measured", measured}};
    return figure;
  }
  measured["cases"] = Json::object();
  double wrong = 0, largest = 0, corrected = 0, least_ratio = 1e300, most_ratio = 0;
  for (const Case& c : cases(run)) {
    const Surface surface(c.o1, {.resolution = resolution});
    const std::vector<Result> results = measure(run, surface, Sites(c.o2));
    const Result &all = results[0], &printed = results[1];
    measured["cases"][c.key] = to_json(results);
    wrong = std::max(wrong, printed.errors.wrong);
    largest = std::max(largest, printed.errors.largest);
    corrected = std::max(corrected, all.errors.wrong);
    const double ratio = 1 / relative_time(printed, results);
    least_ratio = std::min(least_ratio, ratio);
    most_ratio = std::max(most_ratio, ratio);

    const View view = view_of(bounds(c.o1), {0.4, -3, 0.6}, 360, 360);
    figure.html.push_back(paragraph(fmt::format("{} ({} and {} triangles), {}²:", c.name,
                                                c.o1.triangles.size(), c.o2.triangles.size(), resolution)));
    figure.html.push_back(row(
        {panel(wrong_in_red(surface, printed.errors.wrong_texels, view), "As printed; wrong texels in red"),
         panel(wrong_in_red(surface, all.errors.wrong_texels, view), "All corrections")}));
    figure.html.push_back(charts_and_table(results));
  }
  figure.measured = fmt::format(
      "On {}. As printed, up to {:.3g} % of the texels are wrong, by up to {:.2g} % of the diagonal; with "
      "all corrections {:.3g} %. All corrections together take {:.2g} to {:.2g} times the time as printed.{}",
      run.machine.gl_text(), wrong, 100 * largest, corrected, least_ratio, most_ratio, about_signs);
  figure.html.push_back(
      paragraph("wrong: texels whose distance, vector or site is wrong by more than 2 millionths of the "
                "diagonal of both meshes, or that have no value; errors in millionths of that diagonal; "
                "repaired: texels that confirmation recomputed. Each correction is added alone to the "
                "algorithm as printed. docs/theory.md explains them."));
  figure.comparisons = {
      {"Algorithm 1 as printed, wrong texels", "none", fmt::format("up to {:.3g} %", wrong)},
      {"Algorithm 1 corrected, wrong texels", "none", fmt::format("{:.3g} %", corrected)}};
  figure.json = {{"paper", {{"error_at_samples", 0}}}, {"measured", measured}};
  return figure;
}

}  // namespace sdm::figures
