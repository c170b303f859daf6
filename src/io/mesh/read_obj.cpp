#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/mesh_attributes.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "core/excerpt.h"
#include "io/file/file_below.h"
#include "io/file/text_scanner.h"
#include "io/mesh/formats.h"
#include "io/mesh/read_mtl.h"

namespace sdm::io {
namespace {

// The highest index in any face, and its position. Faces may precede the items that they refer to, so it is
// checked at the end.
struct HighestIndex {
  std::uint32_t index = 0;
  const char* at = nullptr;

  void add(std::uint32_t other, const char* place) {
    if (!at || other > index) {
      index = other;
      at = place;
    }
  }
};

// The index that a file means: positive ones count from 1, negative ones backwards from the last of the
// `count` items so far. The result counts from 0; kNone if it cannot exist.
std::uint32_t index_of(std::int64_t i, std::size_t count) {
  const std::int64_t index = i > 0 ? i - 1 : static_cast<std::int64_t>(count) + i;
  return i == 0 || index < 0 || index >= kNone ? kNone : static_cast<std::uint32_t>(index);
}

class ObjReader {
 public:
  ObjReader(std::string_view text, std::filesystem::path folder, bool attributes)
      : in_(text), folder_(std::move(folder)), with_attributes_(attributes) {
    normals_ = {.name = "normal", .components = 3, .domain = PolygonDomain::corner, .values = {}, .rows = {}};
    colors_ = {.name = "color", .components = 3, .domain = PolygonDomain::vertex, .values = {}, .rows = {}};
  }

  PolygonMesh read() {
    for (; !in_.at_end(); in_.skip_line()) {
      if (!in_.more_on_line()) continue;
      if (in_.accept("v"))
        read_position();
      else if (in_.accept("vt"))
        read_uv();
      else if (with_attributes_ && in_.accept("vn"))
        read_normal();
      else if (in_.accept("f"))
        read_face();
      else if (with_attributes_ && in_.accept("mtllib"))
        read_libraries();
      else if (in_.accept("usemtl"))
        read_name(mesh_.materials);
      else if (in_.accept("g"))
        read_name(mesh_.groups);
      else if (in_.accept("o"))
        read_name(mesh_.objects);
      else if (in_.accept("l"))
        ++lines_;
      else if (in_.accept("curv") || in_.accept("curv2"))
        ++curves_;
      else if (in_.accept("surf"))
        ++surfaces_;
    }
    if (highest_vertex_.at && highest_vertex_.index >= mesh_.positions.size())
      in_.fail_at(highest_vertex_.at,
                  fmt::format("index out of range: a face refers to vertex {} of {}",
                              std::size_t{highest_vertex_.index} + 1, mesh_.positions.size()));
    check_uvs();
    check_other_statements();
    add_attributes();
    return std::move(mesh_);
  }

 private:
  void read_position() {
    const double x = in_.number(), y = in_.number(), z = in_.number();
    mesh_.positions.push_back({x, y, z});
    if (with_attributes_) read_color();
  }
  // Three numbers after the coordinates; a single one is a weight. The convention of many programs: sRGB.
  void read_color() {
    std::array<float, 3> color{};
    std::size_t count = 0;
    for (; in_.more_on_line(); ++count) {
      const auto x = static_cast<float>(in_.number());
      if (count < 3) color[count] = linear_light(x);
    }
    has_colors_ |= count == 3;
    if (count != 3) color.fill(std::numeric_limits<float>::quiet_NaN());
    colors_.values.insert(colors_.values.end(), color.begin(), color.end());
  }
  void read_normal() {
    for (int k = 0; k < 3; ++k) normals_.values.push_back(static_cast<float>(in_.number()));
  }
  void read_uv() {
    const double u = in_.number();
    mesh_.uvs.push_back({u, in_.more_on_line() ? in_.number() : 0});
  }
  // Corners are v, v/vt, v//vn or v/vt/vn.
  void read_face() {
    while (in_.more_on_line()) {
      mesh_.corners.push_back(read_vertex_index());
      std::uint32_t uv = kNone, normal = kNone;
      if (in_.accept('/')) {
        if (in_.in_word() && !in_.accept('/')) {
          uv = read_uv_index();
          in_.accept('/');
        }
        if (in_.in_word()) normal = index_of(in_.integer(), normals_.count());
      }
      mesh_.corner_uvs.push_back(uv);
      if (with_attributes_) normals_.rows.push_back(normal);
    }
    mesh_.end_polygon();
    if (with_attributes_) normals_.rows.resize(mesh_.corners.size());  // without those of a dropped polygon
  }
  std::uint32_t read_vertex_index() {
    const char* at = in_.position();
    const std::int64_t i = in_.integer();
    const std::uint32_t index = index_of(i, mesh_.positions.size());
    if (index == kNone)
      in_.fail_at(
          at, fmt::format("index out of range: a face refers to vertex {} of {}", i, mesh_.positions.size()));
    highest_vertex_.add(index, at);
    return index;
  }
  std::uint32_t read_uv_index() {
    const char* at = in_.position();
    const std::int64_t i = in_.integer();
    const std::uint32_t index = index_of(i, mesh_.uvs.size());
    if (index != kNone)
      highest_uv_.add(index, at);
    else if (!impossible_uv_)
      impossible_uv_ = {i, at};
    return index;
  }
  // Faces without valid texture coordinates are still faces: programs write vt that they then leave out.
  void check_uvs() {
    if (!impossible_uv_ && highest_uv_.at && highest_uv_.index >= mesh_.uvs.size())
      impossible_uv_ = {std::int64_t{highest_uv_.index} + 1, highest_uv_.at};
    if (!impossible_uv_) return;
    mesh_.notes.push_back(fmt::format(
        "{} left out: in line {}, a face refers to number {} of {}",
        with_attributes_ ? "texture coordinates that do not exist are" : "the texture coordinates are",
        in_.line_of(impossible_uv_->second), impossible_uv_->first, mesh_.uvs.size()));
    if (!with_attributes_) {  // a mesh has them at all corners, attributes at some
      mesh_.uvs.clear();
      mesh_.corner_uvs.clear();
      return;
    }
    for (std::uint32_t& row : mesh_.corner_uvs)
      if (row >= mesh_.uvs.size()) row = kNone;
  }
  // Normals may follow the faces that refer to them; what does not exist is left out.
  void add_attributes() {
    for (std::uint32_t& row : normals_.rows)
      if (row >= normals_.count()) row = kNone;
    if (!normals_.values.empty()) mesh_.attributes.push_back(std::move(normals_));
    if (has_colors_) mesh_.attributes.push_back(std::move(colors_));
    add_materials();
  }
  // A line names one file, whose name may have blanks, or several.
  void read_libraries() {
    if (!in_.more_on_line()) return;
    std::string line(in_.rest_of_line());
    std::ranges::replace(line, '\\', '/');
    if (line.find_first_of(" \t") == std::string::npos || is_library(line)) return read_library(line);
    TextScanner names(line);
    while (names.more_on_line()) read_library(std::string(names.word()));
  }
  bool is_library(const std::string& name) const {
    try {
      return exists_below(folder_, name, "library of materials");
    } catch (const Error&) {  // no path in the folder
      return false;
    }
  }
  // A library that cannot be had leaves its materials without colours.
  void read_library(const std::string& name) {
    has_libraries_ = true;
    try {
      if (!libraries_.insert(file_below(folder_, name, "library of materials")).second) return;
      read_mtl(read_below(folder_, name, "library of materials").view(), folder_, mesh_.surfaces);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& fault) {
      lacks_libraries_ = true;
      mesh_.notes.push_back(fmt::format("the materials of {} are left out: {}", excerpt(name), fault.what()));
    }
  }
  void add_materials() {
    std::map<std::string_view, std::uint32_t> numbers;  // the first one of each name
    for (const Material& material : mesh_.surfaces.list)
      numbers.emplace(material.name, static_cast<std::uint32_t>(&material - mesh_.surfaces.list.data()));
    for (const PolygonNames::Run& run : mesh_.materials.runs()) {
      const auto found = run.name == kNone ? numbers.end() : numbers.find(mesh_.materials.names()[run.name]);
      mesh_.surfaces.runs.push_back({run.first_polygon, found == numbers.end() ? kNone : found->second});
    }
    mesh_.surfaces.move_notes(mesh_.notes);
    if (has_libraries_ && !lacks_libraries_) note_unknown_materials(numbers);
  }
  void note_unknown_materials(const std::map<std::string_view, std::uint32_t>& numbers) {
    std::vector<std::string> unknown;
    for (const std::string& name : mesh_.materials.names())
      if (!numbers.contains(name)) unknown.push_back(name);
    if (unknown.empty()) return;
    mesh_.notes.push_back(fmt::format("no MTL file has the material{} {}, so faces of {} are white",
                                      unknown.size() == 1 ? "" : "s", first_of(unknown),
                                      unknown.size() == 1 ? "it" : "them"));
  }
  void check_other_statements() {
    if (mesh_.ends.empty()) {
      if (curves_ + surfaces_ > 0)
        throw Error(
            "there are no triangles, only free-form curves and surfaces (statements curv and surf); export "
            "the faces of a mesh instead");
      if (lines_ > 0)
        throw Error("there are no triangles, only lines (statement l); export the faces of a mesh instead");
    } else if (surfaces_ > 0) {
      mesh_.notes.push_back(fmt::format(
          "{} free-form surfaces (statement surf) are left out; only the faces are read", surfaces_));
    }
  }
  // The rest of the line: names may contain blanks, and a face may be in several groups.
  void read_name(PolygonNames& names) {
    std::string name;
    while (in_.more_on_line()) name.append(name.empty() ? "" : " ").append(in_.word());
    names.begin(mesh_.ends.size(), name);
  }

  TextScanner in_;
  PolygonMesh mesh_;
  std::filesystem::path folder_;
  std::set<std::filesystem::path> libraries_;  // that were read
  bool with_attributes_, has_colors_ = false, has_libraries_ = false, lacks_libraries_ = false;
  PolygonAttribute normals_, colors_;
  HighestIndex highest_vertex_, highest_uv_;
  std::optional<std::pair<std::int64_t, const char*>> impossible_uv_;  // the first one and its position
  std::size_t lines_ = 0, curves_ = 0, surfaces_ = 0;                  // statements
};

}  // namespace

PolygonMesh read_obj(std::string_view text, const std::filesystem::path& file, bool attributes) {
  return ObjReader(text, file.parent_path(), attributes).read();
}

}  // namespace sdm::io
