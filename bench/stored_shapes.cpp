// Building a shape, and reading it from a file.
#include <sdm/map_files.h>
#include <sdm/proximity_query.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "core/stopwatch.h"
#include "harness.h"
#include "timing.h"

namespace sdm::bench {
namespace {

// 2 n m triangles: a torus with waves.
Mesh wavy_torus(std::uint32_t n, std::uint32_t m) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / m;
      const double r = 0.4 * (1 + 0.1 * std::sin(7 * u) * std::sin(5 * v)), ring = 1 + r * std::cos(v);
      mesh.positions.push_back({ring * std::cos(u), ring * std::sin(u), r * std::sin(v)});
      const std::uint32_t right = (i + 1) % n, up = (j + 1) % m;
      mesh.triangles.push_back({i * m + j, right * m + j, right * m + up});
      mesh.triangles.push_back({i * m + j, right * m + up, i * m + up});
    }
  return mesh;
}

// The medians of the times of a call: elapsed, and of the processor for all threads.
Row row(const char* step, int repetitions, const std::function<void()>& call) {
  std::vector<double> wall, processor;
  for (int i = 0; i < repetitions; ++i) {
    Stopwatch watch;
    const std::clock_t used = std::clock();
    call();
    processor.push_back(1e3 * static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC);
    wall.push_back(watch.lap());
  }
  return {step, {{"wall_ms", median(wall)}, {"processor_ms", median(processor)}}};
}

// The results of the first queries of a fresh shape.
std::vector<double> answers(const Shape& shape, const Shape& other) {
  ProximityQuery query(shape, other);
  std::vector<double> found;
  for (const double x : {3.0, 1.1, 0.9}) {
    query.set_pose(1, Transform::translation({x, 0.1, 0.2}));
    found.push_back(query.separation().value);
    if (const auto& depth = query.penetration_depth()) found.push_back(depth->value);
    for (const Contact& contact : query.contacts()) found.push_back(contact.depth);
  }
  return found;
}

Outcome stored_shape(const Trial& trial) {
  const Mesh mesh = wavy_torus(200, 100);
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "sdm-bench.shape";
  const Shape built(mesh), other(wavy_torus(30, 20));
  write_shape(file, built);
  Outcome outcome{.counts = {{"triangles", static_cast<double>(mesh.triangles.size())},
                             {"bytes", static_cast<double>(std::filesystem::file_size(file))}}};
  outcome.verified = answers(read_shape(file), other) == answers(built, other);
  if (outcome.verified) {
    std::optional<Shape> shape;
    const auto time = [&](const char* step, const std::function<void()>& call) {
      outcome.rows.push_back(row(step, trial.repetitions, call));
    };
    time("build", [&] { shape.emplace(mesh); });
    time("read", [&] { shape.emplace(read_shape(file)); });
    time("write", [&] { write_shape(file, built); });
    time("build, first queries", [&] { answers(shape.emplace(mesh), other); });
    time("read, first queries", [&] { answers(shape.emplace(read_shape(file)), other); });
  }
  std::filesystem::remove(file);
  return outcome;
}

}  // namespace

Program program() {
  return {
      .name = "stored_shapes",
      .description =
          "Building a shape of 40,000 triangles, reading it from a file, and the first queries of both",
      .repetition = "calls",
      .cases = {
          {.name = "torus", .description = "A torus with waves", .run = stored_shape, .repetitions = 21}}};
}

}  // namespace sdm::bench
