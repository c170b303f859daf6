// Section 6.3: time, memory and error against the resolution n, of maps and of volumes, with fitted
// exponents.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "research/figures/charts/chart.h"
#include "research/figures/figures.h"
#include "research/figures/maps.h"
#include "research/figures/pieces.h"
#include "research/figures/resolution_study.h"

namespace sdm::figures {
namespace {

using Sizes = std::vector<std::uint32_t>;

std::vector<Method> methods_of(Run& run, const Study& study) {
  std::vector<Method> methods;
  methods.push_back(
      study_maps(run, study, nullptr, run.choose(Sizes{128, 256, 512, 1024, 2048}, Sizes{128, 256, 512})));
  if (run.gl)
    methods.push_back(
        study_maps(run, study, run.gl, run.choose(Sizes{128, 256, 512, 1024}, Sizes{128, 256, 512})));
  const Sizes volumes = run.choose(Sizes{16, 32, 64, 128, 192}, Sizes{16, 24, 32});
  for (const fields::Method kind :
       {fields::Method::best, fields::Method::linear_factorization, fields::Method::difi})
    methods.push_back(study_volumes(run, study, kind, volumes));
  methods.push_back(
      study_volumes(run, study, fields::Method::brute_force, run.choose(Sizes{16, 32, 64}, Sizes{12, 16})));
  return methods;
}

/// The value of `y` where `x` is `at`, on the line between the rows around it, with logarithmic axes; nothing
/// beyond the rows.
std::optional<double> between_rows(const std::vector<double>& x, const std::vector<double>& y, double at) {
  for (std::size_t i = 1; i < x.size(); ++i) {
    if (!(std::min(x[i - 1], x[i]) <= at && at <= std::max(x[i - 1], x[i])) || x[i] == x[i - 1]) continue;
    const double part = std::log(at / x[i - 1]) / std::log(x[i] / x[i - 1]);
    return y[i - 1] * std::pow(y[i] / y[i - 1], part);
  }
  return std::nullopt;
}

/// Errors of each method with the memory, and in the time, of a row of the map by the cpu engine.
std::string at_equal_cost(const std::vector<Method>& methods, Json& json) {
  const Method& map = methods.front();
  const std::size_t row = std::min<std::size_t>(2, map.n.size() - 1);
  const double bytes = map.bytes[row], ms = map.times[row].median();
  std::vector<std::vector<std::string>> rows;
  const auto text = [](const std::optional<double>& e) {
    return e ? fmt::format("{:.1e}", *e) : "not measured";
  };
  for (const Method& m : methods) {
    const auto memory_nearest = between_rows(m.bytes, m.nearest, bytes),
               memory_linear = between_rows(m.bytes, m.linear, bytes),
               time_nearest = between_rows(m.medians(), m.nearest, ms),
               time_linear = between_rows(m.medians(), m.linear, ms);
    rows.push_back(
        {m.name, text(memory_nearest), text(memory_linear), text(time_nearest), text(time_linear)});
    const auto value = [](const std::optional<double>& e) { return e ? Json(*e) : Json(nullptr); };
    json[m.key] = {
        {"equal_memory", {{"error_nearest", value(memory_nearest)}, {"error_linear", value(memory_linear)}}},
        // These depend on times, and so differ from run to run.
        {"equal_time_ms", {{"error_nearest", value(time_nearest)}, {"error_linear", value(time_linear)}}}};
  }
  return paragraph(fmt::format("Errors at equal cost: with the memory ({:.3g} MB) and in the time ({:.3g} "
                               "ms) of the map of {:g}² by the cpu engine, on straight lines between the "
                               "rows below, with logarithmic axes.",
                               bytes / 1e6, ms, map.n[row])) +
         table({"method", "equal memory, nearest", "equal memory, linear", "equal time, nearest",
                "equal time, linear"},
               rows);
}

std::vector<std::string> row_of(const Method& m, std::size_t i) {
  return {m.name,
          fmt::format("{:g}", m.n[i]),
          m.times[i].text(),
          fmt::format("{:.3g} MB", m.bytes[i] / 1e6),
          fmt::format("{:.2e}", m.nearest[i]),
          fmt::format("{:.2e}", m.linear[i]),
          fmt::format("{:.2e}", m.bound[i])};
}

std::vector<std::string> fit_of(const Method& m) {
  const auto exponent = [&](const std::vector<double>& y) {
    return fmt::format("{:.2f}", fitted_exponent(m.n, y));
  };
  return {m.name,           exponent(m.medians()), exponent(m.bytes), exponent(m.nearest), exponent(m.linear),
          exponent(m.bound)};
}

std::string chart(const std::vector<Method>& methods, const char* title, const char* x_label,
                  const std::function<std::vector<double>(const Method&)>& x, const char* y_label,
                  const std::function<std::vector<double>(const Method&)>& y) {
  Chart result{.title = title, .x = {.label = x_label, .log = true}, .y = {.label = y_label, .log = true}};
  for (const Method& m : methods) result.series.push_back({.name = m.name, .x = x(m), .y = y(m)});
  return panel(to_svg(result), "");
}

}  // namespace

Figure table_complexity(Run& run) {
  const auto meshes = run.letters().meshes(0);
  const Sites sites(meshes[1]);
  const SurfacePoints points = surface_points(meshes[0], sites, run.choose(20000u, 4000u));
  const std::vector<Method> methods =
      methods_of(run, {meshes[0], sites, points, Pair(meshes, 64).diagonal()});

  std::vector<std::vector<std::string>> rows, fits;
  Json measured = Json::object();
  bool bounded = true;
  for (const Method& m : methods) {
    for (std::size_t i = 0; i < m.n.size(); ++i) {
      rows.push_back(row_of(m, i));
      bounded &= m.nearest[i] <= m.bound[i] * (1 + 1e-6) + 4e-6;
    }
    fits.push_back(fit_of(m));
    measured[m.key] = m.json();
  }
  measured["bounds_hold"] = bounded;
  fits.push_back({"map, the paper", "0 to 2 with m", "2", "−1", "", "−1"});
  fits.push_back({"volume, the paper", "3", "3", "−1", "", "−1"});

  const auto n = [](const Method& m) { return m.n; };
  const auto ms = [](const Method& m) { return m.medians(); };
  const auto bytes = [](const Method& m) { return m.bytes; };
  const auto nearest = [](const Method& m) { return m.nearest; };
  const auto linear = [](const Method& m) { return m.linear; };
  Figure figure{
      .key = "table_complexity",
      .title = "Section 6.3: time, memory and error against resolution",
      .paper =
          "With m sites, an n × n × n volume takes O(n³) memory and between O(n³) and O(m n³) time, with an "
          "error of √3/(2n); an n × n map O(n²) memory and between O(n²) and O(m n²) time, with an error of "
          "√2/(2n).",
      .measured = fmt::format(
          "The distances from the letter E to the letter G, in the first frame of the scene; volumes cover "
          "the bounds of E only. Errors are the largest at {} points all over the surface of E, relative to "
          "the diagonal of both letters. Nearest: the value of the nearest texel or grid point, as the "
          "paper's analysis has it. Linear: with the closest point that a map stores for the texel, or "
          "interpolated linearly in the volume; the error then falls with n², which the paper does not "
          "consider. {} Volumetric methods run on the processor.",
          points.points.size(),
          bounded ? "No error of a nearest value exceeds its bound."
                  : "An error exceeds its bound, which is a fault.")};
  figure.html = {chart(methods, "Time against resolution", "resolution n", n, "time (ms)", ms),
                 chart(methods, "Error against memory, nearest", "memory of the values (bytes)", bytes,
                       "largest error (of the diagonal)", nearest),
                 chart(methods, "Error against memory, linear", "memory of the values (bytes)", bytes,
                       "largest error (of the diagonal)", linear),
                 at_equal_cost(methods, measured["equal_cost"]),
                 paragraph("Exponents of n, fitted by least squares:"),
                 table({"method", "time", "memory", "error, nearest", "error, linear", "bound"}, fits),
                 table({"method", "n", "time", "memory", "error, nearest", "error, linear", "bound"}, rows)};
  figure.json = {{"paper",
                  {{"map", {{"time_exponent_most", 2}, {"bytes_exponent", 2}, {"error_exponent", -1}}},
                   {"volume", {{"time_exponent_most", 3}, {"bytes_exponent", 3}, {"error_exponent", -1}}}}},
                 {"measured", measured}};
  return figure;
}

}  // namespace sdm::figures
