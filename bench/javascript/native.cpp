// The calls of native.mjs with the library itself, on one thread: native FOLDER RESOLUTION. The folder has
// the arrays of the pair as files of plain numbers. A word on standard input is a call: its answer is its
// time in milliseconds, or, of `write`, that the results are in the folder.
#include <hwy/targets.h>
#include <sdm/closest_points.h>
#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace sdm;

template <class T>
std::vector<T> read(const std::filesystem::path& file) {
  std::vector<T> values(std::filesystem::file_size(file) / sizeof(T));
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
  if (!in) throw std::runtime_error(file.string() + " cannot be read");
  return values;
}
template <class T>
void write(const std::filesystem::path& file, const std::vector<T>& values) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(T)));
  if (!out.flush()) throw std::runtime_error(file.string() + " cannot be written");
}

Mesh read_mesh(const std::filesystem::path& folder, const std::string& name) {
  return {read<Vec3>(folder / (name + ".positions")), read<Triangle>(folder / (name + ".indices")), {}};
}

void answer_calls(const std::filesystem::path& folder, std::uint32_t resolution) {
  const Mesh o2 = read_mesh(folder, "o2");
  const auto points = read<Vec3>(folder / "points");
  const Surface surface(read_mesh(folder, "o1"), {.resolution = resolution},
                        read<std::uint8_t>(folder / "atlas"));
  const Sites sites(o2);
  DistanceMap map = empty_map(surface);
  std::vector<ClosestPoint> closest;
  const std::map<std::string, std::function<void()>> calls{
      {"sites", [&] { Sites again(o2); }},
      {"map", [&] { compute_map(surface, sites, {}, map); }},
      {"points", [&] { closest = closest_points(sites, points, {}); }},
  };
  for (std::string call; std::cin >> call;) {
    if (call == "write") {
      std::vector<double> distances;
      for (const ClosestPoint& one : closest) distances.push_back(one.distance);
      write(folder / "map.native",
            std::vector(map.distance.begin(),
                        map.distance.begin() + static_cast<std::ptrdiff_t>(map.texels())));
      write(folder / "points.native", distances);
      std::cout << "written" << std::endl;
      continue;
    }
    const auto begin = std::chrono::steady_clock::now();
    calls.at(call)();
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
    std::cout << time.count() << std::endl;
  }
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 3) throw std::runtime_error("usage: native FOLDER RESOLUTION");
  if ((hwy::SupportedTargets() & HWY_SSE4) == 0) throw std::runtime_error("the processor has no SSE4");
  const ThreadLimit one(1);
  answer_calls(arguments[1], static_cast<std::uint32_t>(std::stoul(arguments[2])));
} catch (const std::exception& error) {
  std::cerr << "native: " << error.what() << '\n';
  return 1;
}
