// Distance fields: narrow bands of three cells against OpenVDB's meshToVolume, sites and tree included; and
// all methods on the letter E, on the grid of the paper's Figure 8. Ratios are those of the peer's time, or
// the method's, to ours. Verifies that every method agrees with the reference engine at every point.
//
//   build/dev/bench/fields [--list] [--filter REGEX] [--repetitions N] [--threads N] [--json FILE]
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <sdm/sdm.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "harness.h"
#include "research/fields/fields.h"
#include "scenes.h"
#include "scenes/scene.h"
#include "timing.h"

namespace sdm::bench {
namespace {

Box enlarged(Box box, double by) {
  for (int k = 0; k < 3; ++k) {
    box.lower[k] -= by;
    box.upper[k] += by;
  }
  return box;
}

bool agree(std::string_view method, const DistanceField& field, const DistanceField& reference) {
  const double tolerance = field.accuracy + reference.accuracy;
  for (std::size_t i = 0; i < field.distance.size(); ++i) {
    const double d = field.distance[i], e = reference.distance[i];
    const bool border = std::abs(std::abs(std::isnan(d) ? e : d) - field.max_distance) <= tolerance;
    if (std::isnan(d) != std::isnan(e) ? !border : std::abs(std::abs(d) - std::abs(e)) > tolerance) {
      std::fprintf(stderr, "%s is wrong at point %zu: %g, not %g\n", std::string(method).c_str(), i, d, e);
      return false;
    }
  }
  return true;
}

// A mesh as OpenVDB reads it: in the coordinates of the grid's indices.
struct IndexSpaceMesh {
  const Mesh& mesh;
  const Grid& grid;

  [[nodiscard]] std::size_t polygonCount() const { return mesh.triangles.size(); }
  [[nodiscard]] std::size_t pointCount() const { return mesh.positions.size(); }
  [[nodiscard]] std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t face, std::size_t corner, openvdb::Vec3d& p) const {
    const Vec3& v = mesh.positions[mesh.triangles[face][corner]];
    for (int k = 0; k < 3; ++k) p[k] = (v[k] - grid.origin[k]) / grid.spacing[k];
  }
};

Outcome against_openvdb(const Trial& trial, const std::string& file, double cells_across) {
  constexpr float kCells = 3;
  const Mesh mesh = load(file);
  Box box = bounds(mesh);
  double longest = 0;
  for (int k = 0; k < 3; ++k) longest = std::max(longest, box.upper[k] - box.lower[k]);
  const double spacing = longest / cells_across;
  const Grid grid = make_grid(enlarged(box, (kCells + 1) * spacing), spacing);
  const FieldOptions options{.max_distance = kCells * spacing};

  Outcome outcome;
  const Sites sites(mesh);
  DistanceField ours = compute_field(sites, grid, options);
  outcome.verified =
      agree("best", ours,
            fields::compute_field(
                sites, grid, {.method = fields::Method::reference, .max_distance = options.max_distance}));
  const auto transform = openvdb::math::Transform::createLinearTransform(spacing);
  const Race signed_race = race({[&] { ours = compute_field(Sites(mesh), grid, options); }, trial.threads},
                                {[&] {
                                   openvdb::tools::meshToVolume<openvdb::FloatGrid>(
                                       IndexSpaceMesh{mesh, grid}, *transform, kCells, kCells);
                                 },
                                 trial.threads},
                                trial.repetitions);
  outcome.rows.push_back({"", signed_race.figures()});
  outcome.counts = {{"points", static_cast<double>(grid.size())},
                    {"in_band", static_cast<double>(grid.size() - ours.beyond_max_distance)}};
  return outcome;
}

Outcome methods(const Trial& trial, double band_in_cells) {
  const scenes::Scene scene(scenes::SceneKind::letters);
  const Mesh& mesh = scene.bodies()[0].mesh;
  const Grid grid = make_grid(enlarged(bounds(mesh), 0.1), {180, 150, 256});
  const Sites sites(mesh);
  fields::Options options{.sign = SignMethod::none};
  if (band_in_cells > 0) options.max_distance = band_in_cells * std::ranges::max(grid.spacing);
  const auto compute = [&](fields::Method method) {
    fields::Options with = options;
    with.method = method;
    return fields::compute_field(sites, grid, with);
  };
  Outcome outcome{.verified = true};
  const DistanceField reference = compute(fields::Method::reference);
  for (const fields::MethodInfo& method : fields::methods()) {
    if (method.method == fields::Method::reference || (method.needs_max_distance && band_in_cells == 0))
      continue;
    const fields::Field field = compute(method.method);
    outcome.verified &= agree(method.name, field, reference);
    if (method.method == fields::Method::best) continue;
    const Race r = race({[&] { (void)compute(fields::Method::best); }, trial.threads},
                        {[&] { (void)compute(method.method); }, trial.threads}, trial.repetitions);
    Row row{std::string(method.name), r.figures()};
    row.figures.push_back({"evaluations_per_point",
                           static_cast<double>(field.work.evaluations) / static_cast<double>(grid.size())});
    outcome.rows.push_back(std::move(row));
  }
  return outcome;
}

std::vector<Case> cases() {
  std::vector<Case> cases;
  for (const auto& [name, file] : {std::pair{"bunny", "bunny.obj"}, {"armadillo", "armadillo.off"}})
    for (const double cells : {64.0, 256.0})
      cases.push_back({name + std::string("_") + std::to_string(static_cast<int>(cells)),
                       "level set, three cells to both sides, against OpenVDB",
                       [file, cells](const Trial& trial) { return against_openvdb(trial, file, cells); }, 5});
  cases.push_back({"letter", "all methods on a letter, 180 × 150 × 256 points",
                   [](const Trial& trial) { return methods(trial, 0); }, 3, 0});
  cases.push_back({"letter_band", "the same in a band of three cells",
                   [](const Trial& trial) { return methods(trial, 3); }, 3, 0});
  return cases;
}

}  // namespace

Program program() {
  openvdb::initialize();
  return {.name = "fields",
          .description = "Distance fields against OpenVDB and the methods of the literature",
          .repetition = "computations",
          .cases = cases()};
}

}  // namespace sdm::bench
