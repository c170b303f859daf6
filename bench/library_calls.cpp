// Times the calls of the C++ library that bench/python compares those from Python with.
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>
#include "samples.h"

namespace sdm::bench {
namespace {

std::vector<Vec3> read_points(const std::filesystem::path& file) {
  std::vector<Vec3> points(std::filesystem::file_size(file) / sizeof(Vec3));
  std::ifstream(file, std::ios::binary)
      .read(reinterpret_cast<char*>(points.data()),
            static_cast<std::streamsize>(points.size() * sizeof(Vec3)));
  return points;
}

template <class Call>
double milliseconds(Call call) {
  const auto begin = std::chrono::steady_clock::now();
  [[maybe_unused]] const auto result = call();  // destroyed after the end
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

struct LibraryCalls {
  std::filesystem::path o1, o2, file;
};

void time_calls(const LibraryCalls& options) {
  const auto& [o1, o2, file] = options;
  const Surface surface(read_mesh(o1), {.resolution = 1024});
  const Sites sites(read_mesh(o2));
  const std::vector<Vec3> points = read_points(file);
  for (std::string line; std::getline(std::cin, line);) {
    double ms = 0;
    if (line == "points") {
      ms = milliseconds([&] { return closest_points(sites, points); });
    } else if (line == "one") {
      constexpr int kCalls = 10000;
      ms = milliseconds([&] {
             double sum = 0;
             for (int i = 0; i < kCalls; ++i) sum += closest_points(sites, {&points[i], 1})[0].distance;
             return sum;
           }) /
           kCalls;
    } else if (line == "map") {
      ms = milliseconds([&] { return compute_map(surface, sites); });
    }
    std::cout << ms << std::endl;
  }
}

}  // namespace

void add_calls(CLI::App& program) {
  CLI::App& app =
      *program.add_subcommand("calls",
                              "For each line of the standard input, makes a call and prints the milliseconds "
                              "it takes. points: closest_points of all points; one: of a single point, the "
                              "mean of 10,000 calls; map: compute_map at 1024².");
  const auto options = std::make_shared<LibraryCalls>();
  app.add_option("O1", options->o1, "A mesh file")->required();
  app.add_option("O2", options->o2, "A mesh file")->required();
  app.add_option("POINTS", options->file, "float64, three for each point")->required();
  app.callback([options] { time_calls(*options); });
}

}  // namespace sdm::bench
