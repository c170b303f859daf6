// Section 4.2: the pairs of site and face that hierarchical culling saves.
#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "gl/raster_report.h"
#include "io/mesh/placement.h"
#include "research/figures/figures.h"
#include "research/figures/pieces.h"
#include "research/figures/timing.h"
#include "scenes/bunny.h"
#include "scenes/reduce_mesh.h"

namespace sdm::figures {
namespace {

struct Case {
  std::string key, name;
  Mesh o1, o2;
};

std::vector<Case> cases(Run& run) {
  const auto [e, g] = run.letters().meshes(0);
  const scenes::Scene scene(scenes::SceneKind::figure);
  const Mesh &figure = scene.bodies()[0].mesh, &box = scene.bodies()[1].mesh;
  Mesh bunny = scenes::read_bunny(run.mesh);
  io::place(bunny, io::parse_placement("fit"));
  bunny = scenes::reduce_mesh(bunny, run.choose(10000u, 2000u));
  Mesh other = bunny;
  io::place(other, io::parse_placement("rotate:0:90:0,translate:1.1:0:0"));
  std::vector<Case> result{{"letters", "letter E to letter G", e, g},
                           {"box_to_figure", "box to figure", box, figure}};
  result.push_back(
      {"bunnies", fmt::format("bunny to bunny, {} triangles each", bunny.triangles.size()), bunny, other});
  if (!run.quick) result.insert(result.begin() + 1, {"figure_to_box", "figure to box", figure, box});
  return result;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<std::uint32_t, float>,
                            std::bit_cast<std::uint32_t, float>);
}

Json counts_json(const gl::RasterReport& r, const Times& times) {
  return {{"pairs", r.pairs},
          {"culled_by_bound", r.culled_by_bound},
          {"culled_by_obb", r.culled_by_obb},
          {"clipped_away", r.clipped_away},
          {"polygons", r.polygons},
          {"fragments", r.fragments},
          {"texels", r.texels},
          {"map_ms", to_json(times)}};
}

std::vector<std::string> table_row(const std::string& name, const gl::RasterReport& r, const Times& times) {
  const auto share = [&](std::uint64_t n) {
    return fmt::format("{:.3g} %", 100 * static_cast<double>(n) / static_cast<double>(r.pairs));
  };
  const auto per_texel = [&](std::uint64_t n) {
    return fmt::format("{:.3g}", static_cast<double>(n) / static_cast<double>(r.texels));
  };
  return {name,
          fmt::to_string(r.pairs),
          share(r.culled_by_bound),
          share(r.culled_by_obb),
          share(r.clipped_away),
          share(r.polygons),
          per_texel(r.fragments),
          fmt::format("{:.3g} ms", times.median())};
}

}  // namespace

Figure culling(Run& run) {
  Figure figure{
      .key = "culling",
      .title = "Section 4.2: what hierarchical culling saves",
      .paper =
          "Overlap tests of the oriented boxes of sites against the AABB tree of O1, and distance bounds at "
          "its nodes, reduce the pairs of triangle and site. No numbers are given."};
  figure.json = {{"paper", Json::object()}, {"measured", nullptr}};
  if (!run.gl) {
    figure.measured = "Not measured: there is no OpenGL 4.5 device.";
    return figure;
  }
  const std::uint32_t resolution = run.choose(256u, 128u);
  const auto with = make_gl_engine({}), without = make_gl_engine({.bound_culling = false});
  std::vector<std::vector<std::string>> rows;
  Json measured{{"resolution", resolution}};
  double least_saved = 1e300, most_saved = 0;
  bool same = true;
  for (const Case& c : cases(run)) {
    run.step("culling");
    const Surface surface(c.o1, {.resolution = resolution});
    const Sites sites(c.o2);
    DistanceMap a, b;
    const auto map = [&](const auto& engine, DistanceMap& m) {
      compute_map(surface, sites, {.engine = engine, .sign = SignMethod::none}, m);
    };
    const std::function<void()> work[] = {[&] { map(with, a); }, [&] { map(without, b); }};
    const std::vector<Times> times = take_turns(work, run.choose(3, 1));
    const gl::RasterReport r = gl::raster_report(*with).value(), all = gl::raster_report(*without).value();
    const double saved = static_cast<double>(all.polygons) / static_cast<double>(r.polygons);
    least_saved = std::min(least_saved, saved);
    most_saved = std::max(most_saved, saved);
    same &= same_bits(a.distance, b.distance);
    rows.push_back(table_row(c.name + ", with bounds", r, times[0]));
    rows.push_back(table_row(c.name + ", without", all, times[1]));
    measured[c.key] = {{"with_bounds", counts_json(r, times[0])},
                       {"without_bounds", counts_json(all, times[1])}};
  }
  measured["maps_identical"] = same;
  figure.measured = fmt::format(
      "Maps of {}² by the gl engine on {}. Without the distance bounds, {:.2g} to {:.2g} times as many "
      "polygons are drawn. {} The bounds are upper bounds: with the lower bounds that the paper's text "
      "names, sites that are closest would be culled.",
      resolution, run.machine.gl_text(), least_saved, most_saved,
      same ? "The maps with and without bounds are bit-identical." : "The maps differ, which is a fault.");
  figure.html = {
      table({"map", "pairs", "culled by bound", "by oriented box", "clipped away", "drawn",
             "fragments per texel", "time"},
            rows),
      paragraph("A pair is a site of O2 and the texels of one face of O1 in a square of 16 × 16 texels; "
                "percentages are of all pairs, which each have one outcome.")};
  figure.json["measured"] = measured;
  return figure;
}

}  // namespace sdm::figures
