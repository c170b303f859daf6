// Times the calls of the C++ library that bench/python compares those from Python with.
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace {

std::vector<sdm::Vec3> read_points(const std::filesystem::path& file) {
  std::vector<sdm::Vec3> points(std::filesystem::file_size(file) / sizeof(sdm::Vec3));
  std::ifstream(file, std::ios::binary)
      .read(reinterpret_cast<char*>(points.data()),
            static_cast<std::streamsize>(points.size() * sizeof(sdm::Vec3)));
  return points;
}

template <class Call>
double milliseconds(Call call) {
  const auto begin = std::chrono::steady_clock::now();
  [[maybe_unused]] const auto result = call();  // destroyed after the end
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app(
      "For each line of the standard input, makes a call and prints the milliseconds it takes. points: "
      "closest_points of all points; one: of a single point, the mean of 10,000 calls; map: compute_map at "
      "1024².");
  std::filesystem::path o1, o2, file;
  app.add_option("O1", o1, "A mesh file")->required();
  app.add_option("O2", o2, "A mesh file")->required();
  app.add_option("POINTS", file, "float64, three for each point")->required();
  CLI11_PARSE(app, argc, argv);
  const sdm::Surface surface(sdm::read_mesh(o1), {.resolution = 1024});
  const sdm::Sites sites(sdm::read_mesh(o2));
  const std::vector<sdm::Vec3> points = read_points(file);
  for (std::string line; std::getline(std::cin, line);) {
    double ms = 0;
    if (line == "points") {
      ms = milliseconds([&] { return sdm::closest_points(sites, points); });
    } else if (line == "one") {
      constexpr int kCalls = 10000;
      ms = milliseconds([&] {
             double sum = 0;
             for (int i = 0; i < kCalls; ++i) sum += sdm::closest_points(sites, {&points[i], 1})[0].distance;
             return sum;
           }) /
           kCalls;
    } else if (line == "map") {
      ms = milliseconds([&] { return sdm::compute_map(surface, sites); });
    }
    std::cout << ms << std::endl;
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "library_calls: %s\n", error.what());
  return 1;
}
