#include "sites/face_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sdm::sites {
namespace {

// A unit vector at a right angle to the unit vector `a`.
Vec3 any_beside(const Vec3& a) {
  Vec3 axis{};
  axis[static_cast<std::size_t>(std::ranges::min_element(a, {}, [](double x) { return std::abs(x); }) -
                                a.begin())] = 1;
  const Vec3 v = axis - dot(axis, a) * a;
  return (1 / norm(v)) * v;
}

// The direction of v beside `along`. One projection leaves a part along `along` if v is nearly parallel to
// it; after a second one, little is left where nothing but rounding errors was.
Vec3 direction_beside(const Vec3& along, const Vec3& v) {
  Vec3 beside = v - dot(v, along) * along;
  const double size = norm(beside);
  if (!(size > std::numeric_limits<double>::min())) return any_beside(along);
  beside = (1 / size) * beside;
  beside = beside - dot(beside, along) * along;
  const double left = norm(beside);
  return left > 0.5 ? (1 / left) * beside : any_beside(along);
}

void set_side(FaceFrames::Side& side, std::size_t lane, double along, double beside) {
  const double length = std::hypot(along, beside);
  side.along[lane] = static_cast<float>(length > 0 ? along / length : 1);
  side.beside[lane] = static_cast<float>(length > 0 ? beside / length : 0);
  side.length[lane] = static_cast<float>(length);
}

}  // namespace

void FaceFrames::set(std::size_t lane, const Corners& corners) {
  double squared[3];
  for (int k = 0; k < 3; ++k) squared[k] = squared_norm(corners[(k + 1) % 3] - corners[k]);
  const auto first = static_cast<int>(std::max_element(squared, squared + 3) - squared);
  const Vec3 &a = corners[first], ab = corners[(first + 1) % 3] - a, ac_vector = corners[(first + 2) % 3] - a;
  const double ab_length = std::sqrt(squared[first]);
  const Vec3 x = ab_length > 0 ? (1 / ab_length) * ab : Vec3{1, 0, 0};
  const Vec3 y = direction_beside(x, ac_vector), z = cross(x, y);
  for (int k = 0; k < 3; ++k) {
    origin[k][lane] = static_cast<float>(a[k]);
    along[k][lane] = static_cast<float>(x[k]);
    beside[k][lane] = static_cast<float>(y[k]);
    normal[k][lane] = static_cast<float>(z[k]);
  }
  length[lane] = static_cast<float>(ab_length);
  const double c_along = dot(ac_vector, x), c_beside = dot(ac_vector, y);
  set_side(ac, lane, c_along, c_beside);
  set_side(bc, lane, c_along - ab_length, c_beside);
}

void FaceFrames::set_unused(std::size_t lane) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  set(lane, {Vec3{kNaN, kNaN, kNaN}, Vec3{kNaN, kNaN, kNaN}, Vec3{kNaN, kNaN, kNaN}});
  face[lane] = kNone;
}

LeafFrames::Store::Store(std::size_t leaves)
    : frames(std::make_unique_for_overwrite<FaceFrames[]>(leaves)),
      made(std::make_unique<std::atomic<std::uint32_t>[]>(leaves)) {}

LeafFrames::Store& LeafFrames::Shared::get(std::size_t leaves) {
  if (Store* const present = store.load(std::memory_order_acquire)) return *present;
  auto fresh = std::make_unique<Store>(leaves);
  Store* present = nullptr;
  if (store.compare_exchange_strong(present, fresh.get(), std::memory_order_acq_rel)) return *fresh.release();
  return *present;  // of another thread
}

void LeafFrames::forget() {
  if (++version_ == kBeingMade) *this = {};
}

LeafFrames::View::View(const LeafFrames& frames, const FrameSource& source)
    : source_(source), version_(frames.version_) {
  const Store& store = frames.shared_.get(source.leaves.size() - 1);
  frames_ = store.frames.get();
  made_ = store.made.get();
}

const FaceFrames& LeafFrames::View::make(std::uint32_t leaf) {
  std::uint32_t before = made_[leaf].load(std::memory_order_relaxed);
  const bool ours = before != kBeingMade && before != version_ &&
                    made_[leaf].compare_exchange_strong(before, kBeingMade, std::memory_order_acquire);
  FaceFrames& frames = ours ? frames_[leaf] : own_;
  const std::uint32_t first = source_.leaves[leaf], count = source_.leaves[leaf + 1] - first;
  for (std::uint32_t lane = 0; lane < FaceFrames::kWidth; ++lane) {
    if (lane >= count) {
      frames.set_unused(lane);
      continue;
    }
    const std::uint32_t face = source_.faces[first + lane];
    const auto [a, b, c] = corners_of(source_.positions, source_.triangles[face]);
    const UnitFrame& unit = source_.frame;
    frames.set(lane, {unit.to_unit(a), unit.to_unit(b), unit.to_unit(c)});
    frames.face[lane] = face;
  }
  if (ours) made_[leaf].store(version_, std::memory_order_release);
  return frames;
}

}  // namespace sdm::sites
