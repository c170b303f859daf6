// OpenVDB's files, version 224, which OpenVDB reads from 6.2 on: one grid of the type Tree_float_5_4_3, with
// "active mask" compression: of the inactive values, which are the background or its negation, only the signs
// are stored. Written here because libopenvdb takes 30 ms to load, six times as long as all other libraries
// of the command together (docs/dependencies.md); the tests read the files with it.
#include <sdm/version.h>

#include <limits>
#include <string>

#include "io/fields/far_signs.h"
#include "io/fields/formats.h"
#include "io/fields/vdb_nodes.h"
#include "io/file/little_endian.h"

namespace sdm::io {
namespace {

constexpr std::uint32_t kLeafSide = 8, kLowerSide = 16 * kLeafSide, kUpperSide = 32 * kLowerSide;
using LeafMask = NodeMask<3>;
using LowerMask = NodeMask<4>;
using UpperMask = NodeMask<5>;

class Bytes {
 public:
  explicit Bytes(std::ostream& out) : out_(out) {}

  template <class T>
  void put(T value) {
    append_little_endian(bytes_, value);
  }
  void put(bool value) { put(static_cast<char>(value)); }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
  }
  void put(const Vec3& v) {
    for (const double x : v) put(x);
  }
  void put_raw(const std::string& text) { bytes_ += text; }
  template <int kLog2>
  void put(const NodeMask<kLog2>& mask) {
    for (const std::uint64_t word : mask.words) put(word);
  }
  void flush_if_large() {
    constexpr std::size_t kLarge = 1 << 20;
    if (bytes_.size() > kLarge) flush();
  }
  [[nodiscard]] std::int64_t position() {
    flush();
    return out_.tellp();
  }
  /// Replaces what was put at a position.
  void put_at(std::int64_t position, std::span<const std::int64_t> values) {
    flush();
    out_.seekp(position);
    for (const std::int64_t value : values) put(value);
    flush();
    out_.seekp(0, std::ios::end);
  }

 private:
  void flush() {
    out_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    bytes_.clear();
  }
  std::ostream& out_;
  std::string bytes_;
};

class VdbTree {
 public:
  VdbTree(const DistanceField& field, float background, Bytes& out)
      : field_(field),
        background_(background),
        inside_(has_far_signs(field) ? far_signs(field) : std::vector<bool>()),
        leaves_(field.grid.dims, kLeafSide),
        lowers_(field.grid.dims, kLowerSide),
        uppers_(field.grid.dims, kUpperSide),
        out_(out) {
    const Index3& dims = field.grid.dims;
    std::size_t i = 0;
    for (std::uint32_t z = 0; z < dims[2]; ++z)
      for (std::uint32_t y = 0; y < dims[1]; ++y)
        for (std::uint32_t x = 0; x < dims[0]; ++x, ++i)
          if (!std::isnan(field.distance[i])) leaves_.set({x / kLeafSide, y / kLeafSide, z / kLeafSide});
    for_each_used(leaves_, [&](const Index3& b) {
      lowers_.set({b[0] / 16, b[1] / 16, b[2] / 16});
      uppers_.set({b[0] / 512, b[1] / 512, b[2] / 512});
    });
  }

  /// The shape of the tree, without the values of leaves.
  void put_topology() {
    out_.put(std::uint32_t{1});  // buffers per leaf
    out_.put(background_);
    out_.put(std::uint32_t{0});  // tiles of the root
    std::uint32_t children = 0;
    for_each_used(uppers_, [&](const Index3&) { ++children; });
    out_.put(children);
    for_each_used(uppers_, [&](const Index3& upper) {
      for (const std::uint32_t x : kUpperSide* upper) out_.put(static_cast<std::int32_t>(x));
      put_node<UpperMask>(kLowerSide, 32 * upper, lowers_, [&](const Index3& lower) {
        put_node<LowerMask>(kLeafSide, 16 * lower, leaves_,
                            [&](const Index3& leaf) { out_.put(active(kLeafSide * leaf)); });
      });
    });
  }

  /// The values of the leaves, in the same order.
  void put_buffers() {
    for_each_used(uppers_, [&](const Index3& upper) {
      for_children<UpperMask>(32 * upper, lowers_, [&](const Index3& lower) {
        for_children<LowerMask>(16 * lower, leaves_, [&](const Index3& leaf) { put_leaf(kLeafSide * leaf); });
      });
    });
  }

 private:
  // How inactive values are stored.
  enum Inactive : char { kAllPositive = 0, kAllNegative = 1, kMask = 3 };

  template <class Visit>
  static void for_each_used(const BlockTable& table, const Visit& visit) {
    const Index3& n = table.dims();
    for (std::uint32_t z = 0; z < n[2]; ++z)
      for (std::uint32_t y = 0; y < n[1]; ++y)
        for (std::uint32_t x = 0; x < n[0]; ++x)
          if (table.used({x, y, z})) visit(Index3{x, y, z});
  }
  template <class Mask, class Visit>
  static void for_children(const Index3& first, const BlockTable& table, const Visit& visit) {
    for (std::uint32_t i = 0; i < Mask::kSize; ++i)
      if (const Index3 child = first + Mask::place(i); table.used(child)) visit(child);
  }

  // An inner node with children of `side` points; `first` is the first of them.
  template <class Mask, class Visit>
  void put_node(std::uint32_t side, const Index3& first, const BlockTable& table, const Visit& put_child) {
    Mask children, positive;
    for (std::uint32_t i = 0; i < Mask::kSize; ++i) {
      const Index3 child = first + Mask::place(i);
      if (table.used(child))
        children.set(i);
      else if (!is_inside(side * child))
        positive.set(i);
    }
    out_.put(children);
    out_.put(Mask());  // active tiles
    put_inactive(positive, Mask::kSize - children.count);
    for_children<Mask>(first, table, put_child);
    out_.flush_if_large();
  }

  template <class Mask>
  void put_inactive(const Mask& positive, std::uint32_t inactive) {
    const Inactive kind = positive.count == inactive ? kAllPositive
                          : positive.count == 0      ? kAllNegative
                                                     : kMask;
    out_.put(static_cast<char>(kind));
    if (kind == kMask) out_.put(positive);
  }

  [[nodiscard]] bool in_grid(const Index3& p) const {
    const Index3& n = field_.grid.dims;
    return p[0] < n[0] && p[1] < n[1] && p[2] < n[2];
  }
  // Whether a point without a value is inside.
  [[nodiscard]] bool is_inside(const Index3& p) const {
    return !inside_.empty() && in_grid(p) && inside_[field_.grid.index(p[0], p[1], p[2])];
  }
  // NaN outside of the grid.
  [[nodiscard]] float value(const Index3& p) const {
    return in_grid(p) ? field_.distance[field_.grid.index(p[0], p[1], p[2])]
                      : std::numeric_limits<float>::quiet_NaN();
  }
  [[nodiscard]] LeafMask active(const Index3& first) const {
    LeafMask mask;
    for (std::uint32_t i = 0; i < LeafMask::kSize; ++i)
      if (!std::isnan(value(first + LeafMask::place(i)))) mask.set(i);
    return mask;
  }

  void put_leaf(const Index3& first) {
    const LeafMask mask = active(first);
    LeafMask positive;
    for (std::uint32_t i = 0; i < LeafMask::kSize; ++i)
      if (!mask[i] && !is_inside(first + LeafMask::place(i))) positive.set(i);
    out_.put(mask);
    put_inactive(positive, LeafMask::kSize - mask.count);
    for (std::uint32_t i = 0; i < LeafMask::kSize; ++i)
      if (mask[i]) out_.put(value(first + LeafMask::place(i)));
    out_.flush_if_large();
  }

  const DistanceField& field_;
  const float background_;
  const std::vector<bool> inside_;  // of points without a value; empty: not known
  BlockTable leaves_, lowers_, uppers_;
  Bytes& out_;
};

void put_metadata(Bytes& out, const std::string& name, const std::string& text) {
  out.put(name);
  out.put(std::string("string"));
  out.put(text);
}

// The map from the indices of points to their coordinates.
void put_transform(Bytes& out, const Grid& grid) {
  const Vec3& h = grid.spacing;
  const bool uniform = h[0] == h[1] && h[0] == h[2];
  out.put(std::string(uniform ? "UniformScaleTranslateMap" : "ScaleTranslateMap"));
  out.put(grid.origin);
  out.put(h);
  out.put(h);  // the size of a voxel
  out.put(Vec3{1 / h[0], 1 / h[1], 1 / h[2]});
  out.put(Vec3{1 / (h[0] * h[0]), 1 / (h[1] * h[1]), 1 / (h[2] * h[2])});
  out.put(Vec3{0.5 / h[0], 0.5 / h[1], 0.5 / h[2]});
}

float background_of(const DistanceField& field) {
  if (field.max_distance < kInfinity) return static_cast<float>(field.max_distance);
  float largest = 0;
  for (const float d : field.distance)
    if (std::abs(d) > largest) largest = std::abs(d);
  return largest;
}

}  // namespace

void write_field_vdb(std::ostream& stream, const DistanceField& field) {
  constexpr std::int64_t kMagic = 0x56444220;
  constexpr std::uint32_t kFileVersion = 224, kMajor = 10, kMinor = 0, kActiveMask = 2;
  Bytes out(stream);
  out.put(kMagic);
  out.put(kFileVersion);
  out.put(kMajor);
  out.put(kMinor);
  out.put(true);                                        // with the positions of grids
  out.put_raw("00000000-0000-0000-0000-000000000000");  // an identifier, which readers do not need
  out.put(std::uint32_t{1});
  put_metadata(out, "creator", std::string("sdm ") + kVersion);

  out.put(std::uint32_t{1});  // grids
  out.put(std::string("distance"));
  out.put(std::string("Tree_float_5_4_3"));
  out.put(std::string());  // not an instance of another grid
  const std::int64_t positions = out.position();
  for (int k = 0; k < 3; ++k) out.put(std::int64_t{0});

  const std::int64_t grid_position = out.position();
  out.put(kActiveMask);
  const bool level_set = has_far_signs(field) && field.max_distance < kInfinity;
  out.put(std::uint32_t{level_set ? 2u : 1u});
  put_metadata(out, "name", "distance");
  if (level_set) put_metadata(out, "class", "level set");
  put_transform(out, field.grid);
  VdbTree tree(field, background_of(field), out);
  tree.put_topology();
  const std::int64_t block_position = out.position();
  tree.put_buffers();
  out.put_at(positions, std::array{grid_position, block_position, out.position()});
}

}  // namespace sdm::io
