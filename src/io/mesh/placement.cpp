#include "io/mesh/placement.h"

#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

#include "geometry/vec.h"

namespace sdm::io {
namespace {

[[noreturn]] void fail(std::string_view step, const std::string& fault) {
  throw Error("transform step '" + std::string(step) + "' " + fault +
              "; steps are fit, scale:S, rotate:X:Y:Z, translate:X:Y:Z and matrix:FILE");
}

// The numbers after the name of a step, each preceded by a colon.
std::vector<double> parse_values(std::string_view step, std::string_view text) {
  std::vector<double> values;
  while (!text.empty()) {
    text.remove_prefix(1);
    const std::string_view number = text.substr(0, text.find(':'));
    const char* end = number.data() + number.size();
    double value = 0;
    const auto [stop, error] = std::from_chars(number.data(), end, value);
    if (error != std::errc{} || stop != end || !std::isfinite(value))
      fail(step, "has '" + std::string(number) + "' where a number is needed");
    values.push_back(value);
    text.remove_prefix(number.size());
  }
  return values;
}

PlacementStep parse_step(std::string_view step) {
  using Kind = PlacementStep::Kind;
  struct Form {
    std::string_view name;
    Kind kind;
    std::size_t values;
  };
  constexpr Form forms[] = {{"fit", Kind::fit, 0},
                            {"scale", Kind::scale, 1},
                            {"rotate", Kind::rotate, 3},
                            {"translate", Kind::translate, 3}};
  const std::string_view name = step.substr(0, step.find(':'));
  if (name == "matrix") {
    const std::string_view file = step.substr(std::min(name.size() + 1, step.size()));
    if (file.empty()) fail(step, "has no name of a file");
    return {.kind = Kind::file, .file = file};
  }
  for (const Form& form : forms) {
    if (form.name != name) continue;
    const std::vector<double> values = parse_values(step, step.substr(name.size()));
    if (values.size() != form.values)
      fail(step, "has " + std::to_string(values.size()) + " numbers, not " + std::to_string(form.values));
    PlacementStep result{.kind = form.kind};
    std::copy(values.begin(), values.end(), result.value.begin());
    if (form.kind == Kind::scale && result.value[0] == 0) fail(step, "would flatten the mesh to a point");
    return result;
  }
  fail(step, "is not known");
}

// Rotates by `degrees` about an axis, counter-clockwise seen from its tip. Multiples of 90° are exact.
void rotate(std::span<Vec3> points, int axis, double degrees) {
  const double turn = std::remainder(degrees, 360);
  const double radians = turn * (std::numbers::pi / 180);
  const double s = std::abs(turn) == 180 ? 0 : std::sin(radians);
  const double c = std::abs(turn) == 90 ? 0 : std::cos(radians);
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  for (Vec3& p : points) {
    const double x = p[i], y = p[j];
    p[i] = c * x - s * y;
    p[j] = s * x + c * y;
  }
}

// After a reflection: reverses the faces, so that their outside stays outside.
void turn_faces(Mesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  for (auto& uv : mesh.corner_uvs) std::swap(uv[1], uv[2]);
}

struct Fit {
  Vec3 centre;
  double longest;
};

Fit fit_of(const Mesh& mesh) {
  const Box box = bounds(mesh);
  const Vec3 size = box.upper - box.lower;
  const double longest = std::max({size[0], size[1], size[2]});
  if (!(longest > 0)) throw Error("transform step 'fit' requires a mesh with positive extent");
  return {centre(box), longest};
}

// Replaces the file of a step by its matrix.
void read_file(PlacementStep& step) {
  if (step.kind == PlacementStep::Kind::file)
    step = {.kind = PlacementStep::Kind::matrix, .matrix = read_matrix(step.file)};
}

void apply_step(std::span<Vec3> points, const PlacementStep& step) {
  switch (step.kind) {
    case PlacementStep::Kind::fit:
      throw Error("transform step 'fit' needs a mesh");
    case PlacementStep::Kind::scale:
      for (Vec3& p : points) p = step.value[0] * p;
      break;
    case PlacementStep::Kind::rotate:
      for (int axis = 0; axis < 3; ++axis) rotate(points, axis, step.value[axis]);
      break;
    case PlacementStep::Kind::translate:
      for (Vec3& p : points) p += step.value;
      break;
    case PlacementStep::Kind::file:
      transform(points, read_matrix(step.file));
      break;
    case PlacementStep::Kind::matrix:
      transform(points, step.matrix);
      break;
  }
  for (const Vec3& p : points)
    if (!finite(p)) throw Error("the transform produces an infinite coordinate; use smaller values");
}

}  // namespace

std::vector<PlacementStep> parse_placement(std::string_view text) {
  std::vector<PlacementStep> steps;
  while (!text.empty()) {
    const std::size_t comma = text.find(',');
    steps.push_back(parse_step(text.substr(0, comma)));
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
    if (text.empty()) fail(text, "is empty");
  }
  return steps;
}

void place(Mesh& mesh, const std::vector<PlacementStep>& steps) {
  for (PlacementStep step : steps) {
    read_file(step);
    if (step.kind == PlacementStep::Kind::matrix) {
      transform(mesh, step.matrix);
      continue;
    }
    if (step.kind == PlacementStep::Kind::fit) {
      const Fit fit = fit_of(mesh);
      for (Vec3& p : mesh.positions) {
        const Vec3 q = p - fit.centre;
        p = {q[0] / fit.longest, q[1] / fit.longest, q[2] / fit.longest};
      }
      continue;
    }
    apply_step(mesh.positions, step);
    if (step.kind == PlacementStep::Kind::scale && step.value[0] < 0) turn_faces(mesh);
  }
}

void place(std::span<Vec3> points, const std::vector<PlacementStep>& steps) {
  for (const PlacementStep& step : steps) apply_step(points, step);
}

Transform transform_of(const std::vector<PlacementStep>& steps) {
  Transform result;
  for (PlacementStep step : steps) {
    read_file(step);
    switch (step.kind) {
      case PlacementStep::Kind::scale:
        result = Transform::scaling(step.value[0]) * result;
        break;
      case PlacementStep::Kind::rotate:
        result = Transform::rotation(step.value) * result;
        break;
      case PlacementStep::Kind::translate:
        result = Transform::translation(step.value) * result;
        break;
      case PlacementStep::Kind::matrix:
        result = step.matrix * result;
        break;
      default:
        throw Error("transform step 'fit' needs a mesh");
    }
  }
  return result;
}

std::vector<PlacementStep> without_fit(Mesh mesh, const std::vector<PlacementStep>& steps) {
  std::vector<PlacementStep> result;
  for (PlacementStep step : steps) {
    read_file(step);
    const std::size_t first = result.size();
    if (step.kind == PlacementStep::Kind::fit) {
      const Fit fit = fit_of(mesh);
      result.push_back({.kind = PlacementStep::Kind::translate, .value = -fit.centre});
      result.push_back({.kind = PlacementStep::Kind::scale, .value = {1 / fit.longest, 0, 0}});
    } else {
      result.push_back(step);
    }
    for (std::size_t i = first; i < result.size(); ++i) apply_step(mesh.positions, result[i]);
  }
  return result;
}

}  // namespace sdm::io
