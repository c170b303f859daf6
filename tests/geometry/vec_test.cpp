#include <gtest/gtest.h>
#include <sdm/types.h>

#include <type_traits>
#include <utility>

// A program that uses the library: nothing of sdm but the types is named.
namespace program {
namespace {

template <class Vector>
constexpr bool is_plain(std::size_t bytes) {
  return sizeof(Vector) == bytes && std::is_trivially_copyable_v<Vector> &&
         std::is_standard_layout_v<Vector> && std::is_aggregate_v<Vector>;
}

TEST(PublicVectors, HaveTheLayoutOfArrays) {
  EXPECT_TRUE(is_plain<sdm::Vec2>(16));
  EXPECT_TRUE(is_plain<sdm::Vec3>(24));
  EXPECT_TRUE(is_plain<sdm::Vec3f>(12));
}

TEST(PublicVectors, HaveTheirArithmeticInAnyNamespace) {
  constexpr sdm::Vec3 a{1, 2, 3}, b{4, -5, 6};
  EXPECT_EQ(a + b, (sdm::Vec3{5, -3, 9}));
  EXPECT_EQ(a - b, (sdm::Vec3{-3, 7, -3}));
  EXPECT_EQ(-a, (sdm::Vec3{-1, -2, -3}));
  EXPECT_EQ(2 * a, (sdm::Vec3{2, 4, 6}));
  EXPECT_EQ(dot(a, b), 12);
  EXPECT_EQ(cross(a, b), (sdm::Vec3{27, 6, -13}));
  EXPECT_EQ(squared_norm(a), 14);
  EXPECT_EQ(norm(sdm::Vec3{2, -3, 6}), 7);
  EXPECT_EQ(normalized(sdm::Vec3{0, -4, 0}), (sdm::Vec3{0, -1, 0}));
  EXPECT_EQ(normalized(sdm::Vec3{}), sdm::Vec3{});
  sdm::Vec3 sum = a;
  sum += b;
  EXPECT_EQ(sum, a + b);
}

TEST(PublicVectors, OfThePlaneAndInSinglePrecision) {
  const sdm::Vec2 a{1, 2}, b{3, 5};
  EXPECT_EQ(a + b, (sdm::Vec2{4, 7}));
  EXPECT_EQ(a - b, (sdm::Vec2{-2, -3}));
  EXPECT_EQ(2 * a, (sdm::Vec2{2, 4}));
  EXPECT_EQ(dot(a, b), 13);
  EXPECT_EQ(cross(a, b), -1);
  const sdm::Vec3f c{1, 2, 3}, d{4, 5, 6};
  EXPECT_EQ(c + d, (sdm::Vec3f{5, 7, 9}));
  EXPECT_EQ(c - d, (sdm::Vec3f{-3, -3, -3}));
  EXPECT_EQ(2 * c, (sdm::Vec3f{2, 4, 6}));
  EXPECT_EQ(dot(c, d), 32);
}

TEST(PublicVectors, AreTakenApartByStructuredBindings) {
  sdm::Vec3 v{1, 2, 3};
  auto& [x, y, z] = v;
  std::swap(x, z);
  EXPECT_EQ(v, (sdm::Vec3{3, 2, 1}));
  EXPECT_EQ(y, 2);
}

}  // namespace
}  // namespace program
