#include "io_read/try_read.h"

#include <sdm/error.h>
#include <sdm/mesh.h>
#include <sdm/mesh_files.h>
#include <sdm/points.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace sdm::test {
namespace {

void require(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error(what);
}

// The mesh that frames of positions alone belong to.
std::string rest_mesh(const std::filesystem::path& folder) {
  std::string file = (folder / "rest.off").string();
  if (!std::filesystem::exists(file))
    std::ofstream(file) << "OFF 4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  return file;
}

void read_sequence(const std::filesystem::path& file) {
  const bool positions_alone = file.extension() == ".npy";
  MeshSequence sequence(positions_alone ? rest_mesh(file.parent_path()) + "+" + file.string()
                                        : file.string());
  try {
    validate(sequence.mesh());
  } catch (const Error& fault) {
    throw std::logic_error("not a valid mesh: " + std::string(fault.what()));
  }
  for (std::size_t frame = 0; frame < sequence.frame_count(); ++frame)
    require(sequence.positions(frame).size() == sequence.mesh().positions.size(), "frames of unequal size");
}

bool is_mesh(const std::filesystem::path& file) {
  constexpr std::array kExtensions{".ply", ".obj", ".gltf", ".glb"};
  return std::ranges::count(kExtensions, file.extension()) > 0;
}

void read_attributes(const std::filesystem::path& file) {
  const MeshFile read = read_mesh_file(file, {.attributes = true});
  for (const MeshAttribute& attribute : read.attributes) {
    require(!attribute.name.empty() && attribute.components > 0, "an attribute without a name or numbers");
    require(attribute.values.size() % attribute.components == 0, "an incomplete row");
    require(attribute.rows->size() == read.mesh.triangles.size(), "rows of other faces");
    for (const Triangle& rows : *attribute.rows)
      for (const std::uint32_t row : rows)
        require(row == kNone || row < attribute.values.size() / attribute.components, "no such row");
  }
}

// NaN equals NaN.
bool same(const Vec3& a, const Vec3& b) {
  return std::equal(a.begin(), a.end(), b.begin(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

// The dialect that a text is said to have reads the same points.
void read_again(const std::filesystem::path& file, const TextDialect& dialect) {
  PointReader reader(file), again(file, dialect);
  std::vector<Vec3> points, normals, same_points, same_normals;
  bool more = true;
  while (more) {
    more = reader.read(3, points, normals);
    require(again.read(3, same_points, same_normals) == more, "another number of points");
    require(std::ranges::equal(points, same_points, same), "other points");
    require(std::ranges::equal(normals, same_normals, same), "other normals");
  }
}

void read_points(const std::filesystem::path& file) {
  constexpr std::size_t kMost = 2;  // in several parts
  PointReader reader(file);
  std::vector<Vec3> points, normals;
  std::uint64_t count = 0;
  while (reader.read(kMost, points, normals)) {
    require(!points.empty() && points.size() <= kMost, "a part of another size");
    require(normals.size() == (reader.has_normals() ? points.size() : 0), "normals of another number");
    count += points.size();
  }
  require(!reader.count() || *reader.count() == count, "not as many points as the header says");
  require(count <= std::filesystem::file_size(file), "more points than bytes");
  if (const auto dialect = reader.dialect()) read_again(file, *dialect);
}

void read_transform(const std::filesystem::path& file) {
  const Transform matrix = read_matrix(file);
  for (const auto& row : matrix.rows)
    for (const double x : row) require(std::isfinite(x), "a matrix that is not finite");
}

}  // namespace

bool try_read(const std::filesystem::path& file) {
  const std::string extension = file.extension();
  const bool is_cloud =
      std::ranges::count(std::array{".xyz", ".csv", ".pts", ".ptx", ".pcd", ".las", ".cloud"}, extension) > 0;
  try {
    if (is_cloud)
      read_points(file);
    else if (extension == ".matrix")
      read_transform(file);
    else
      read_sequence(file);
    if (is_mesh(file)) read_attributes(file);
    return true;
  } catch (const Error& fault) {
    const std::string message = fault.what();
    require(!message.empty() && message.find('\n') == std::string::npos,
            "an error not of one line: " + message);
    return false;
  }
}

}  // namespace sdm::test
