#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/error.h>
#include <sdm/hausdorff.h>
#include <sdm/map.h>
#include <sdm/map_files.h>
#include <sdm/measure.h>
#include <sdm/mesh_edit.h>
#include <sdm/proximity_query.h>
#include <sdm/rays.h>
#include <sdm/sites.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <new>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "bodies/shape/body.h"
#include "core/checksum.h"
#include "support/error_of.h"
#include "support/meshes.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm {
namespace {

using testing::HasSubstr;
using Block = std::vector<std::byte>;

Block block_of(const Shape& shape) {
  Block block;
  shape.store(
      [&](std::span<const std::byte> bytes) { block.insert(block.end(), bytes.begin(), bytes.end()); });
  return block;
}

// A shape of a copy of the bytes.
Shape shape_from(std::span<const std::byte> block, bool trusted = false) {
  constexpr std::align_val_t kAlignment{64};
  auto* const data = static_cast<std::byte*>(::operator new(block.size() + 1, kAlignment));
  const std::shared_ptr<void> owner(data, [](void* memory) { ::operator delete(memory, kAlignment); });
  std::ranges::copy(block, data);
  return Shape(StoredShape{.bytes = {data, block.size()}, .owner = owner, .trusted = trusted});
}

// The header and the table of sizes, as core/arrays/stored_arrays.h describes them.
constexpr std::size_t kVersionAt = 8, kCountAt = 12, kSizeAt = 16, kSumAt = 24, kTableAt = 32;

template <class T>
T number_at(const Block& block, std::size_t at) {
  T value;
  std::memcpy(&value, block.data() + at, sizeof value);
  return value;
}
template <class T>
void set_number(Block& block, std::size_t at, T value) {
  std::memcpy(block.data() + at, &value, sizeof value);
}

// Makes the checksum right again.
void reseal(Block& block) {
  constexpr std::size_t kPart = std::size_t{1} << 18;
  set_number(block, kSumAt, std::uint64_t{0});
  std::vector<std::uint64_t> parts;
  for (std::size_t at = kTableAt; at < block.size(); at += kPart)
    parts.push_back(XXH3_64bits(block.data() + at, std::min(kPart, block.size() - at)));
  core::Checksum sum;
  sum.add(std::span<const std::byte>(block).first(kTableAt));
  sum.add(parts);
  set_number(block, kSumAt, sum.value());
}

struct ArrayPlace {
  std::size_t begin, size;
};
std::vector<ArrayPlace> arrays_of(const Block& block) {
  const auto count = number_at<std::uint32_t>(block, kCountAt);
  std::vector<ArrayPlace> places;
  std::size_t end = kTableAt + 16 * std::size_t{count};
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = (end + 63) / 64 * 64;
    const std::size_t size = number_at<std::uint64_t>(block, kTableAt + 16 * i) *
                             number_at<std::uint64_t>(block, kTableAt + 16 * i + 8);
    places.push_back({begin, size});
    end = begin + size;
  }
  return places;
}

// Whether a word of an array is an index, a count or a flag, by their order in SitesData and Body: the others
// are coordinates, normals and bounds.
bool is_index(std::size_t array, std::size_t word) {
  switch (array) {
    case 0:   // positions
    case 2:   // texture coordinates
    case 20:  // bounds of leaves
    case 23:  // regions of faces
    case 27:  // largest radius
    case 34:  // normals of faces
    case 35:  // normals of vertices
    case 38:  // cylinders
      return false;
    case 16:  // nodes of the tree: a box, three indices
      return word % 9 >= 6;
    case 18:  // nodes of the wide tree: boxes, children and their sources
      return word % 72 >= 48;
    case 24:  // regions of edges: the edge is last
    case 25:  // and of vertices
      return word % 16 == 15;
    case 26:  // points
      return word % 4 == 3;
    default:
      return true;
  }
}

class Answers {
 public:
  void add(double x) { bits_.push_back(std::bit_cast<std::uint64_t>(x)); }
  void add(const Vec3& p) {
    for (const double x : {p[0], p[1], p[2]}) add(x);
  }
  void add(const BoundedLength& length) {
    add(length.value);
    add(length.lower);
    add(length.upper);
    if (length.witness)
      for (const Vec3& p : *length.witness) add(p);
  }
  void add(const Contact& contact) {
    add(contact.point1);
    add(contact.point2);
    add(contact.normal);
    add(contact.depth);
    add(contact.patch);
    bits_.push_back(contact.id);
    for (const SurfacePoint& on : contact.on) bits_.push_back(on.face);
  }
  bool operator==(const Answers&) const = default;
  [[nodiscard]] std::size_t size() const { return bits_.size(); }

 private:
  std::vector<std::uint64_t> bits_;
};

Transform pose_of(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&](double size) {
    return Vec3{size * number(random), size * number(random), size * number(random)};
  };
  return Transform::translation(vector(reach)) * Transform::rotation(vector(180));
}

// Those of all queries of a pair in several poses, of which some overlap.
Answers answers(const Shape& a, const Shape& b, int poses = 12) {
  std::mt19937 random(5);
  Answers found;
  ProximityQuery query(a, b, {.contact_margin = 0.05});
  for (int i = 0; i < poses; ++i) {
    query.set_pose(1, pose_of(random, i % 3 == 0 ? 2.5 : 0.9));
    found.add(query.separation());
    found.add(query.colliding() ? 1 : 0);
    if (const auto& depth = query.penetration_depth()) found.add(*depth);
    for (const Contact& contact : query.contacts()) found.add(contact);
    const SeparatingTranslation& way = query.separating_translation();
    found.add(way.value);
    found.add(way.lower);
    found.add(way.translation);
    for (const Contact& contact : query.separating_contacts()) found.add(contact);
  }
  return found;
}

std::vector<Mesh> all_kinds() {
  std::mt19937 random(3);
  return {test::load("head.off", "fit"),
          test::sphere(2),
          test::torus(24, 16),
          test::cube(0.7),
          test::height_field(12),
          test::soup(60, random),
          test::degenerate_soup(80, 4),
          test::ring(9),
          test::joined(test::sphere(2), test::cube(0.3)),
          test::single_triangle(),
          test::with_defects(test::torus(12, 9))};
}

TEST(StoredShape, GivesTheSameAnswers) {
  const Shape other(test::torus(20, 12));
  for (const Mesh& mesh : all_kinds()) {
    const Shape built(mesh), loaded = shape_from(block_of(built));
    EXPECT_EQ(answers(built, other), answers(loaded, other)) << mesh.triangles.size();
    EXPECT_EQ(answers(other, built, 5), answers(other, loaded, 5)) << mesh.triangles.size();
    EXPECT_EQ(built.convex(), loaded.convex());
    EXPECT_EQ(built.sites().closed(), loaded.sites().closed());
    EXPECT_EQ(built.sites().orientable(), loaded.sites().orientable());
    EXPECT_TRUE(std::ranges::equal(built.sites().edges(), loaded.sites().edges()));
    EXPECT_EQ(built.sites().mesh().positions, loaded.sites().mesh().positions);
    EXPECT_EQ(built.sites().mesh().triangles, loaded.sites().mesh().triangles);
    EXPECT_EQ(block_of(built), block_of(loaded));
  }
}

TEST(StoredShape, ConvexShapesStayConvex) {
  const Shape hull(convex_hull(test::load("head.off", "fit")));
  const Shape loaded = shape_from(block_of(hull)), cube(test::cube(0.6));
  ASSERT_TRUE(hull.convex());
  EXPECT_TRUE(loaded.convex());
  EXPECT_EQ(answers(hull, cube), answers(loaded, cube));
}

TEST(StoredShape, AnswersBeforeAndAfterARefitAreTheSame) {
  const Mesh mesh = test::load("head.off", "fit");
  const Shape other(test::sphere(3));
  std::vector<Vec3> moved = mesh.positions;
  for (Vec3& p : moved) p[0] *= 1.3;
  const auto refitted = [&](Shape shape) {
    ProximityQuery query(std::move(shape), other, {.contact_margin = 0.05});
    Answers found;
    for (int step = 0; step < 2; ++step) {
      query.refit(step == 0 ? moved : mesh.positions, {});
      query.set_pose(1, Transform::translation({0.4, 0.3, 0.8}));
      found.add(query.separation());
      if (const auto& depth = query.penetration_depth()) found.add(*depth);
      for (const Contact& contact : query.contacts()) found.add(contact);
    }
    return found;
  };
  const Block block = block_of(Shape(mesh));
  EXPECT_EQ(refitted(Shape(mesh)), refitted(shape_from(block)));
}

TEST(StoredShape, CanBeEdited) {
  const Mesh mesh = test::torus(20, 12);
  const Shape other(test::sphere(2));
  const MeshEdit edit{.removed_faces = {7, 8, 100}, .moved_vertices = {{3, {1.6, 0.1, 0.2}}}};
  const auto edited = [&](Shape shape) {
    ProximityQuery query(std::move(shape), other, {.contact_margin = 0.05});
    query.edit(0, edit);
    query.set_pose(1, Transform::translation({1, 0, 0.2}));
    Answers found;
    found.add(query.separation());
    for (const Contact& contact : query.contacts()) found.add(contact);
    return found;
  };
  const Block block = block_of(Shape(mesh));
  EXPECT_EQ(edited(Shape(mesh)), edited(shape_from(block)));
}

// It is stored as it is: without cylinders, and with the tree of the first shape.
TEST(StoredShape, OfADeformedShapeGivesItsAnswers) {
  const Mesh mesh = test::torus(40, 30);
  std::vector<Vec3> moved = mesh.positions;
  for (Vec3& p : moved) p[1] *= 0.8;
  const Shape other(test::sphere(2));
  const Shape shape(mesh);
  internals(shape)->refit(moved);
  EXPECT_EQ(answers(shape, other), answers(shape_from(block_of(shape)), other));
}

TEST(StoredShape, KeepsItsAtlas) {
  const Mesh mesh = test::torus(16, 12);
  const Shape built(mesh, AtlasOptions{.kind = AtlasKind::triangles, .resolution = 128, .gutter = 2});
  const Shape loaded = shape_from(block_of(built));
  EXPECT_EQ(loaded.surface().atlas_kind(), AtlasKind::triangles);
  EXPECT_TRUE(std::ranges::equal(built.surface().texel_faces(), loaded.surface().texel_faces()));
  EXPECT_EQ(built.surface().stored_atlas(), loaded.surface().stored_atlas());
  EXPECT_THROW((void)shape_from(block_of(Shape(mesh))).surface(), Error);
}

TEST(StoredShape, IsRefusedIfDamaged) {
  const Block block = block_of(Shape(test::tetrahedron()));
  for (std::size_t size = 0; size < block.size(); ++size)
    EXPECT_THROW((void)shape_from(std::span(block).first(size)), Error) << size;
  Block longer = block;
  longer.push_back(std::byte{0});
  EXPECT_THAT(test::error_of([&] { return shape_from(longer); }), HasSubstr("is damaged"));
  for (std::size_t i = 0; i < block.size(); ++i) {
    Block changed = block;
    changed[i] ^= std::byte{0x41};
    EXPECT_THROW((void)shape_from(changed), Error) << i;
  }
}

TEST(StoredShape, MessagesSayWhatIsWrong) {
  const Block block = block_of(Shape(test::cube()));
  const auto error = [](Block changed) { return test::error_of([&] { return shape_from(changed); }); };
  EXPECT_EQ(error({}), "this is not a stored shape");
  Block later = block;
  set_number(later, kVersionAt, std::uint32_t{77});
  EXPECT_EQ(
      error(later),
      "another version of sdm has stored the shape (format 77 instead of 1); build it again from its mesh");
  Block shorter(block.begin(), block.end() - 64);
  EXPECT_THAT(error(shorter), HasSubstr("is incomplete: "));
  Block damaged = block;
  damaged[damaged.size() / 2] ^= std::byte{1};
  EXPECT_EQ(error(damaged), "the stored shape is damaged; build it again from its mesh");
}

// Sizes that somebody has changed, with the right checksum.
TEST(StoredShape, ForgedSizesAreRefused) {
  const Block block = block_of(Shape(test::cube()));
  const auto count = number_at<std::uint32_t>(block, kCountAt);
  for (std::size_t at = kTableAt; at < kTableAt + 16 * std::size_t{count}; at += 8)
    for (const std::uint64_t value :
         {std::uint64_t{0}, number_at<std::uint64_t>(block, at) + 1, number_at<std::uint64_t>(block, at) - 1,
          ~std::uint64_t{0} / 8, ~std::uint64_t{0}}) {
      Block forged = block;
      if (value == number_at<std::uint64_t>(block, at)) continue;
      set_number(forged, at, value);
      reseal(forged);
      EXPECT_THROW((void)shape_from(forged), Error) << at << ' ' << value;
    }
  for (const std::uint32_t arrays : {std::uint32_t{0}, count - 1, count + 1, ~std::uint32_t{0}}) {
    Block forged = block;
    set_number(forged, kCountAt, arrays);
    reseal(forged);
    EXPECT_THROW((void)shape_from(forged), Error) << arrays;
  }
}

// Asks a query of a shape whose numbers may be wrong: any answer will do, or an error.
void attempt(const std::function<void()>& query) {
  try {
    query();
  } catch (const Error&) {
  }
}

// Any answer will do, if only there is one.
void ask(const Shape& shape) {
  const Shape other(test::sphere(1));
  (void)answers(shape, other, 3);
  const std::vector<Ray> rays{{{-3, 0.1, 0.2}, {1, 0, 0}}, {{0.1, 0.2, 5}, {0.1, 0, -1}}};
  (void)first_hits(shape.sites(), rays);
  std::vector<Vec3> moved = shape.sites().mesh().positions;
  for (Vec3& p : moved) p[0] *= 1.1;
  ProximityQuery query(shape_from(block_of(shape)), other);
  query.refit(moved, {});
  (void)query.separation();
  (void)query.penetration_depth();
  query.edit(0, {.removed_faces = {0}});
  (void)query.separation();
}

// Indices that somebody has changed, with the right checksum: each is refused, or all queries end.
TEST(StoredShape, ForgedIndicesNeitherCrashNorHang) {
  std::mt19937 random(9);
  int taken = 0, refused = 0;
  for (const Mesh& mesh : {test::torus(12, 9), test::joined(test::cube(0.5), test::cube(1)),
                           test::height_field(6), test::torus(44, 40)}) {
    const Block block = block_of(Shape(mesh));
    const std::vector<ArrayPlace> arrays = arrays_of(block);
    for (int i = 0; i < 300; ++i) {
      Block forged = block;
      for (unsigned changes = 1 + random() % 2; changes > 0; --changes) {
        const std::size_t which = random() % arrays.size();
        const ArrayPlace& array = arrays[which];
        if (array.size < 4) continue;
        const std::size_t word = random() % (array.size / 4), at = array.begin + 4 * word;
        if (!is_index(which, word)) continue;
        const std::uint32_t values[] = {0,
                                        1,
                                        ~0u,
                                        0x80000000u,
                                        0x7F800000u,
                                        number_at<std::uint32_t>(forged, at) + 1,
                                        number_at<std::uint32_t>(forged, at) - 1,
                                        static_cast<std::uint32_t>(random() % 500),
                                        static_cast<std::uint32_t>(random())};
        set_number(forged, at, values[random() % std::size(values)]);
      }
      reseal(forged);
      try {
        const Shape shape = shape_from(forged);
        ++taken;
        if (mesh.triangles.size() < 1000 || i < 60) ask(shape);
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(taken, 100);
  EXPECT_GT(refused, 100);
}

// Every index of a small shape, one after the other.
TEST(StoredShape, ForgedIndicesAreRefusedOrHarmless) {
  const Block block = block_of(Shape(test::cube()));
  const std::vector<ArrayPlace> arrays = arrays_of(block);
  for (std::size_t i = 0; i < arrays.size(); ++i)
    for (std::size_t word = 0; word < arrays[i].size / 4; ++word)
      for (const std::uint32_t value : {~0u, 0x80000000u}) {
        if (!is_index(i, word)) continue;
        Block forged = block;
        set_number(forged, arrays[i].begin + 4 * word, value);
        reseal(forged);
        try {
          const Shape shape = shape_from(forged), other(test::cube(0.5));
          ProximityQuery query(shape, other);
          (void)query.separation();
          (void)query.contacts();
        } catch (const Error&) {
        }
      }
}

// Whether the elements of an array, by their order in SitesData and Body, are of double precision.
bool is_double(std::size_t array) {
  return array == 0 || array == 2 || array == 34 || array == 35;
}

// All queries of a shape, each by itself.
void ask_all(const Shape& shape) {
  static const Shape other(test::torus(7, 5));
  for (const bool first : {true, false})
    for (const double x : {0.3, 3.0}) {
      ProximityQuery query(first ? shape : other, first ? other : shape, {.contact_margin = 0.05});
      query.set_pose(1, Transform::translation({x, 0.1, 0.2}));
      attempt([&] { (void)query.separation(); });
      attempt([&] { (void)query.colliding(); });
      attempt([&] { (void)query.penetration_depth(); });
      attempt([&] { (void)query.contacts(); });
      attempt([&] { (void)query.separating_translation(); });
      attempt([&] { (void)query.separating_contacts(); });
    }
  attempt([&] {
    ProximityQuery query(shape, other);
    query.edit(0, {.removed_faces = {0}});
    (void)query.separation();
  });
  const auto at = [&](double x) { return Transform::translation({x, 0, 0}); };
  attempt([&] { (void)time_of_contact(shape, {at(-3), at(3)}, other, {at(0), at(0)}, 1e-3); });
  std::vector<Vec3> points;
  for (int i = 0; i < 200; ++i) points.push_back({std::sin(i), std::cos(3 * i), 2 * std::sin(7 * i)});
  const Sites& sites = shape.sites();
  attempt([&] { (void)closest_points(sites, points); });
  attempt([&] { (void)closest_points(sites, std::span(points).first(3)); });
  const std::vector<ClosestPoint> none(points.size());
  for (const SignMethod method : {SignMethod::exact, SignMethod::winding})
    attempt([&] { (void)inside_flags(sites, points, none, method); });
  attempt([&] { (void)self_intersections(sites); });
  attempt([&] { (void)one_sided_hausdorff(test::single_triangle(), sites); });
  const std::vector<Ray> rays{{{-3, 0.1, 0.2}, {1, 0, 0}}, {{0.1, 0.2, 5}, {0.1, 0, -1}}};
  attempt([&] { (void)first_hits(sites, rays); });
  attempt([&] {
    (void)distances_at_vertices(sites.mesh(), sites, ThicknessOptions{.method = ThicknessMethod::ball});
  });
  if (shape.has_surface()) attempt([&] { (void)compute_map(shape.surface(), other.sites()); });
}

// Numbers that somebody has changed, with the right checksum: what is not finite, too large or not a box is
// refused, and all other numbers are harmless.
TEST(StoredShape, ForgedNumbersAreRefusedOrHarmless) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(),
                   kInfinity = std::numeric_limits<double>::infinity();
  constexpr std::size_t kFirstOfTrees = 16;  // in large shapes; cylinders are the last of these arrays
  int taken = 0, refused = 0;
  std::mt19937 random(4);
  for (const Mesh& mesh : {test::cube(), test::torus(44, 40)}) {
    const Block block = block_of(Shape(mesh, AtlasOptions{.resolution = 64}));
    const std::vector<ArrayPlace> arrays = arrays_of(block);
    const bool small = mesh.triangles.size() < 100;
    for (std::size_t i = 0; i < arrays.size(); ++i)
      for (const double value : {3e38, kNaN, kInfinity, -1.0, 0.0, 0.25, 1e-30})
        for (const bool all : {true, false}) {
          Block forged = block;
          const std::size_t size = is_double(i) ? 8 : 4, count = arrays[i].size / size;
          const std::size_t only = count == 0 ? 0 : random() % count;
          bool numbers = false;
          for (std::size_t j = all ? 0 : only; j < (all ? count : std::min(count, only + 1)); ++j) {
            if (is_index(i, size / 4 * j)) continue;
            const std::size_t at = arrays[i].begin + size * j;
            is_double(i) ? set_number(forged, at, value) : set_number(forged, at, static_cast<float>(value));
            numbers = true;
          }
          if (!numbers) continue;
          SCOPED_TRACE(testing::Message() << "array " << i << ", " << value << (all ? ", all" : ", one"));
          reseal(forged);
          std::optional<Shape> shape;
          attempt([&] { shape.emplace(shape_from(forged)); });
          if (!shape) {
            ++refused;
            continue;
          }
          EXPECT_FALSE(all && (std::isnan(value) || value == 3e38));
          ++taken;
          if (small || (all && i >= kFirstOfTrees && std::abs(value) > 0.1)) ask_all(*shape);
        }
  }
  EXPECT_GT(taken, 40);
  EXPECT_GT(refused, 200);
}

// All words of an array that is no list of numbers, too: indices, counts, flags and the atlas.
TEST(StoredShape, ForgedArraysAreRefusedOrHarmless) {
  const Block block = block_of(Shape(test::torus(12, 9), AtlasOptions{.resolution = 64}));
  const std::vector<ArrayPlace> arrays = arrays_of(block);
  for (const ArrayPlace& array : arrays)
    for (const std::uint32_t value : {0u, 1u, 0x01010101u, 0x7F61B1E6u, 0x7FC00000u, 0xBF800000u, ~0u}) {
      Block forged = block;
      for (std::size_t at = array.begin; at + 4 <= array.begin + array.size; at += 4)
        set_number(forged, at, value);
      reseal(forged);
      attempt([&] { ask_all(shape_from(forged)); });
    }
}

TEST(StoredShape, TrustedOnesAreCheckedForDamageOnly) {
  const Mesh mesh = test::torus(12, 9);
  Block block = block_of(Shape(mesh));
  const auto trusted = [](const Block& bytes) { return shape_from(bytes, true); };
  EXPECT_EQ(answers(trusted(block), Shape(test::cube())), answers(Shape(mesh), Shape(test::cube())));
  Block forged = block;
  set_number(forged, arrays_of(block)[34].begin, 3e38);  // the normal of a face
  reseal(forged);
  EXPECT_NO_THROW((void)trusted(forged));
  EXPECT_THROW((void)shape_from(forged), Error);
  forged[forged.size() / 2] ^= std::byte{1};
  EXPECT_THROW((void)trusted(forged), Error);
}

TEST(StoredShape, FilesAppearWholeAndNameTheirFault) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "torus.shape";
  const Shape built(test::torus(30, 20)), other(test::cube());
  write_shape(file, built);
  const Shape loaded = read_shape(file);
  write_shape(file, other);  // another file of this name
  std::filesystem::remove(file);
  EXPECT_EQ(answers(built, other), answers(loaded, other));

  EXPECT_EQ(test::error_of([&] { return read_shape(file); }), file.string() + ": there is no such file");
  EXPECT_THAT(test::error_of([&] { return read_shape(folder.path()); }), HasSubstr("not a shape file"));
  std::ofstream(file).flush();
  EXPECT_EQ(test::error_of([&] { return read_shape(file); }), file.string() + ": the file is empty");
  std::ofstream(file) << "solid, but not a shape";
  EXPECT_EQ(test::error_of([&] { return read_shape(file); }), file.string() + ": this is not a stored shape");
  EXPECT_THAT(test::error_of([&] { write_shape(folder / "none" / "x", built); }), HasSubstr("cannot write"));
}

TEST(StoredShape, CanBeUsedByManyThreads) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "shape";
  const Shape built(test::torus(40, 30)), other(test::sphere(2));
  write_shape(file, built);
  const Answers expected = answers(built, other, 4);
  const Shape loaded = read_shape(file);
  std::vector<Answers> found(4);
  {
    std::vector<std::thread> threads;
    for (Answers& mine : found) threads.emplace_back([&] { mine = answers(loaded, other, 4); });
    for (std::thread& thread : threads) thread.join();
  }
  for (const Answers& one : found) EXPECT_EQ(one, expected);
}

}  // namespace
}  // namespace sdm
