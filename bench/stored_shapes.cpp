// Building a shape, and reading it from a file.
#include <sdm/execution.h>
#include <sdm/map_files.h>
#include <sdm/proximity_query.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

namespace {

// 2 n m triangles: a torus with waves.
sdm::Mesh wavy_torus(std::uint32_t n, std::uint32_t m) {
  sdm::Mesh mesh;
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

struct Cost {
  double wall_ms, processor_ms;  // the latter of all threads
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

Cost median_cost(int times, const std::function<void()>& call) {
  std::vector<double> wall, processor;
  for (int i = 0; i < times; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    const std::clock_t used = std::clock();
    call();
    processor.push_back(1e3 * static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC);
    wall.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  return {median(wall), median(processor)};
}

void print(const char* step, const Cost& cost) {
  std::printf("%-24s %8.2f %8.2f\n", step, cost.wall_ms, cost.processor_ms);
}

// The results of the first queries of a fresh shape.
std::vector<double> answers(const sdm::Shape& shape, const sdm::Shape& other) {
  sdm::ProximityQuery query(shape, other);
  std::vector<double> found;
  for (const double x : {3.0, 1.1, 0.9}) {
    query.set_pose(1, sdm::Transform::translation({x, 0.1, 0.2}));
    found.push_back(query.separation().value);
    if (const auto& depth = query.penetration_depth()) found.push_back(depth->value);
    for (const sdm::Contact& contact : query.contacts()) found.push_back(contact.depth);
  }
  return found;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app(
      "Times building a shape of 40,000 triangles, reading it from a file, and the first queries of both.");
  std::filesystem::path folder = std::filesystem::temp_directory_path();
  int times = 21;
  unsigned threads = 1;
  app.add_option("--folder", folder, "Where the file is written");
  app.add_option("--times", times, "Medians of so many");
  app.add_option("--threads", threads, "Threads");
  CLI11_PARSE(app, argc, argv);
  const sdm::ThreadLimit limit(threads);
  const sdm::Mesh mesh = wavy_torus(200, 100);
  const std::filesystem::path file = folder / "sdm-bench.shape";
  const sdm::Shape built(mesh), other(wavy_torus(30, 20));
  sdm::write_shape(file, built);
  const auto size = static_cast<double>(std::filesystem::file_size(file));
  if (answers(sdm::read_shape(file), other) != answers(built, other))
    throw std::runtime_error("the stored shape has other answers");
  std::optional<sdm::Shape> shape;
  std::printf("%zu triangles, %.1f MB, %u threads; medians of %d, ms\n%-24s %8s %8s\n", mesh.triangles.size(),
              size / 1e6, threads, times, "", "wall", "processor");
  print("build", median_cost(times, [&] { shape.emplace(mesh); }));
  print("read", median_cost(times, [&] { shape.emplace(sdm::read_shape(file)); }));
  print("write", median_cost(times, [&] { sdm::write_shape(file, built); }));
  print("build, first queries", median_cost(times, [&] { answers(shape.emplace(mesh), other); }));
  print("read, first queries",
        median_cost(times, [&] { answers(shape.emplace(sdm::read_shape(file)), other); }));
  shape.reset();
  std::filesystem::remove(file);
} catch (const std::exception& error) {
  std::fprintf(stderr, "stored_shapes: %s\n", error.what());
  return 1;
}
