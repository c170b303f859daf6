#include <fmt/format.h>
#include <sdm/error.h>

#include <cmath>

#include "core/cancellation.h"
#include "core/excerpt.h"
#include "io/file/byte_scanner.h"
#include "io/file/text_scanner.h"
#include "io/mesh/formats.h"
#include "io/mesh/ply_attributes.h"
#include "io/mesh/ply_header.h"

namespace sdm::io {
namespace {

using Type = NumberType;
using Element = PlyHeader::Element;
using Property = PlyHeader::Property;

// The two sources of numbers, text and binary. A double represents all PLY types without loss.
class TextSource {
 public:
  explicit TextSource(const TextScanner& text) : rows_(text) {}
  double number(Type) { return rows_.number(); }
  void begin_row() { rows_.begin(); }
  void end_row(const Element& element, std::size_t row) {
    rows_.end([&] { return fmt::format("row {} of element {}", row, element.name); });
  }
  [[nodiscard]] std::size_t remaining() const {
    return rows_.scanner().remaining() + 1;
  }                                                                 // the last newline may be missing
  [[nodiscard]] static std::size_t least_bytes(Type) { return 2; }  // a digit and a blank
  [[nodiscard]] bool has_more() { return rows_.scanner().next_word(); }

 private:
  TextRows rows_;
};

class BinarySource {
 public:
  BinarySource(std::string_view bytes, std::endian order) : in_(bytes, order), order_(order) {}
  double number(Type type) { return load_number(in_.take(size_of(type)).data(), type, order_); }
  void begin_row() {}
  void end_row(const Element&, std::size_t) {}
  [[nodiscard]] std::size_t remaining() const { return in_.remaining(); }
  [[nodiscard]] static std::size_t least_bytes(Type type) { return size_of(type); }
  [[nodiscard]] bool has_more() const {  // than blanks
    ByteScanner rest = in_;
    const std::string_view bytes = rest.take(rest.remaining());
    return bytes.find_first_not_of(std::string_view("\0 \n\r", 4)) != std::string_view::npos;
  }

 private:
  ByteScanner in_;
  std::endian order_;
};

template <typename Source>
class PlyReader {
 public:
  PlyReader(const PlyHeader& header, Source source, bool attributes)
      : header_(header), in_(source), with_attributes_(attributes) {}

  PolygonMesh read() {
    for (const Element& element : header_.elements) {
      if (element.properties.empty()) continue;
      check_size(element);
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else if (element.name == "tristrips")
        read_strips(element);
      else
        for (std::size_t row = 0; row < element.count; ++row) read_row(element, row);
    }
    if (in_.has_more()) mesh_.notes.emplace_back("what follows the declared rows is left out");
    if (mesh_.corner_uvs.size() != mesh_.corners.size()) {
      // Unless all faces have texture coordinates of their own, those of the vertices are used, if any.
      if (!mesh_.corner_uvs.empty() && vertex_uvs_.empty())
        mesh_.notes.emplace_back("the texture coordinates are left out: some faces have none");
      mesh_.uvs = std::move(vertex_uvs_);
      mesh_.corner_uvs = mesh_.uvs.empty() ? std::vector<std::uint32_t>{} : mesh_.corners;
    }
    mesh_.attributes = of_vertices_.take();
    add_face_attributes(mesh_.attributes, of_faces_.take());
    return std::move(mesh_);
  }

 private:
  void check_size(const Element& element) const {
    std::size_t row_bytes = 0;
    for (const Property& p : element.properties)
      row_bytes += Source::least_bytes(p.count_type.value_or(p.type));
    // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): there are properties, each with bytes
    if (element.count > in_.remaining() / row_bytes)
      throw Error(
          fmt::format("the header declares {} rows of element {}, more than the file can hold; it is "
                      "truncated or damaged",
                      element.count, element.name));
  }

  // Reads a row into scalars_ and lists_, both indexed by property.
  void read_row(const Element& element, std::size_t row) {
    due_();
    in_.begin_row();
    scalars_.resize(element.properties.size());
    lists_.resize(element.properties.size());
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const Property& property = element.properties[p];
      if (!property.count_type) {
        scalars_[p] = in_.number(property.type);
        continue;
      }
      lists_[p].clear();
      const double count = in_.number(*property.count_type);
      if (!(count >= 0) || std::trunc(count) != count)
        throw Error(fmt::format("row {} of element {} has a list of {} items", row, element.name, count));
      for (std::size_t k = 0; static_cast<double>(k) < count; ++k)
        lists_[p].push_back(in_.number(property.type));
    }
    in_.end_row(element, row);
  }

  void read_vertices(const Element& element) {
    std::array<std::size_t, 3> place{};
    constexpr std::string_view names[] = {"x", "y", "z"};
    for (int k = 0; k < 3; ++k) {
      const auto found = element.find({names[k]});
      if (!found || element.properties[*found].count_type)
        throw Error(fmt::format("the vertices of the PLY file have no {}", names[k]));
      place[k] = *found;
    }
    const auto u = element.find({"s", "u", "texture_u", "texture_s"});
    const auto v = element.find({"t", "v", "texture_v", "texture_t"});
    const bool has_uvs = u && v && !element.properties[*u].count_type && !element.properties[*v].count_type;
    if (with_attributes_) {
      std::vector<std::size_t> others(place.begin(), place.end());
      if (has_uvs) others.insert(others.end(), {*u, *v});
      of_vertices_ = PlyAttributes(element, PolygonDomain::vertex, std::move(others));
    }
    mesh_.positions.reserve(element.count);
    for (std::size_t row = 0; row < element.count; ++row) {
      read_row(element, row);
      mesh_.positions.push_back({scalars_[place[0]], scalars_[place[1]], scalars_[place[2]]});
      if (has_uvs) vertex_uvs_.push_back({scalars_[*u], scalars_[*v]});
      of_vertices_.add(scalars_);
    }
  }

  // Converts an index, which may have any type in the file.
  [[nodiscard]] std::uint32_t index(double value, const Element& element, std::size_t row) const {
    if (value >= 0 && value < kNone && std::trunc(value) == value) return static_cast<std::uint32_t>(value);
    throw Error(fmt::format("index out of range: row {} of element {} refers to vertex {}", row,
                            excerpt(element.name), value));
  }

  void read_faces(const Element& element) {
    const std::size_t indices = list_place(element, {"vertex_indices", "vertex_index"});
    const auto texcoord = element.find({"texcoord"});
    const bool has_texcoords = texcoord && element.properties[*texcoord].count_type;
    if (with_attributes_) of_faces_ = PlyAttributes(element, PolygonDomain::polygon, {});
    mesh_.ends.reserve(element.count);
    mesh_.corners.reserve(3 * element.count);
    for (std::size_t row = 0; row < element.count; ++row) {
      read_row(element, row);
      const std::vector<double>& face = lists_[indices];
      for (const double value : face) mesh_.corners.push_back(index(value, element, row));
      if (has_texcoords && lists_[*texcoord].size() == 2 * face.size()) {
        const std::vector<double>& uv = lists_[*texcoord];
        for (std::size_t k = 0; k < face.size(); ++k) {
          mesh_.corner_uvs.push_back(static_cast<std::uint32_t>(mesh_.uvs.size()));
          mesh_.uvs.push_back({uv[2 * k], uv[2 * k + 1]});
        }
      }
      const std::size_t before = mesh_.ends.size();
      mesh_.end_polygon();
      if (mesh_.ends.size() > before) of_faces_.add(scalars_);
    }
  }

  // A list contains strips, separated by −1. Every other triangle of a strip is flipped.
  void read_strips(const Element& element) {
    const std::size_t indices = list_place(element, {"vertex_indices", "vertex_index"});
    for (std::size_t row = 0; row < element.count; ++row) {
      read_row(element, row);
      std::vector<std::uint32_t> strip;
      for (const double value : lists_[indices]) {
        if (value == -1) {
          strip.clear();
          continue;
        }
        strip.push_back(index(value, element, row));
        const std::size_t n = strip.size();
        if (n < 3) continue;
        const bool flipped = n % 2 == 0;
        mesh_.corners.insert(mesh_.corners.end(),
                             {strip[n - 3 + flipped], strip[n - 2 - flipped], strip[n - 1]});
        mesh_.end_polygon();
      }
    }
  }

  static std::size_t list_place(const Element& element, std::initializer_list<std::string_view> names) {
    const auto place = element.find(names);
    if (!place || !element.properties[*place].count_type)
      throw Error(
          fmt::format("element {} of the PLY file has no list vertex_indices", excerpt(element.name)));
    return *place;
  }

  const PlyHeader& header_;
  Source in_;
  Poll due_{4096};  // rows
  PolygonMesh mesh_;
  bool with_attributes_;
  PlyAttributes of_vertices_, of_faces_;
  std::vector<Vec2> vertex_uvs_;
  std::vector<double> scalars_;
  std::vector<std::vector<double>> lists_;
};

}  // namespace

PolygonMesh read_ply(std::string_view bytes, bool attributes) {
  const PlyHeader header = parse_ply_header(bytes);
  const std::string_view data = bytes.substr(header.size);
  switch (header.encoding) {
    case PlyHeader::Encoding::text:
      return PlyReader(header, TextSource(TextScanner(bytes, header.size)), attributes).read();
    case PlyHeader::Encoding::little_endian:
      return PlyReader(header, BinarySource(data, std::endian::little), attributes).read();
    case PlyHeader::Encoding::big_endian:
      break;
  }
  return PlyReader(header, BinarySource(data, std::endian::big), attributes).read();
}

}  // namespace sdm::io
