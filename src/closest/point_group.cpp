#include "closest/point_group.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "closest/point_group.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace sdm::closest::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The ball around a packet's points, centred on their bounding box.
void AroundPacket(const PointGroup& group, size_t packet, Ball& ball, tree::FloatBox& box) {
  const hn::CappedTag<float, PointGroup::kPacket> d;
  const auto load = [&](int k, size_t i) HWY_ATTR {
    return hn::Load(d, group.position[k] + PointGroup::kPacket * packet + i);
  };
  for (int k = 0; k < 3; ++k) {
    auto lo = load(k, 0), hi = lo;
    for (size_t i = hn::Lanes(d); i < PointGroup::kPacket; i += hn::Lanes(d)) {
      lo = hn::Min(lo, load(k, i));
      hi = hn::Max(hi, load(k, i));
    }
    box.lower[k] = hn::GetLane(hn::MinOfLanes(d, lo));
    box.upper[k] = hn::GetLane(hn::MaxOfLanes(d, hi));
    ball.centre[k] = 0.5f * (box.lower[k] + box.upper[k]);
  }
  auto most = hn::Zero(d);
  for (size_t i = 0; i < PointGroup::kPacket; i += hn::Lanes(d)) {
    auto squared = hn::Zero(d);
    for (int k = 0; k < 3; ++k) {
      const auto x = hn::Sub(load(k, i), hn::Set(d, ball.centre[k]));
      squared = hn::MulAdd(x, x, squared);
    }
    most = hn::Max(most, squared);
  }
  ball.radius = std::sqrt(hn::GetLane(hn::MaxOfLanes(d, most)));
}

// Maps points into the frame. Returns whether any of them is far away; those are moved to its origin.
bool MoveToFrame(std::span<const Vec3> points, const UnitFrame& frame,
                 float (*position)[PointGroup::kMostPoints]) {
  const hn::CappedTag<double, 8> d;
  const hn::Rebind<float, decltype(d)> df;
  const size_t lanes = hn::Lanes(d);
  size_t i = 0;  // many at a time, as long as all are near
  for (; i + lanes <= points.size(); i += lanes) {
    hn::Vec<decltype(d)> p[3];
    hn::LoadInterleaved3(d, points[i].data(), p[0], p[1], p[2]);
    auto largest = hn::Zero(d);
    for (int k = 0; k < 3; ++k) {
      p[k] = hn::Mul(hn::Sub(p[k], hn::Set(d, frame.origin[k])), hn::Set(d, frame.scale));
      largest = hn::Max(largest, hn::Abs(p[k]));
    }
    if (!hn::AllTrue(d, hn::Lt(largest, hn::Set(d, PointGroup::kFarAway)))) break;
    for (int k = 0; k < 3; ++k) hn::StoreU(hn::DemoteTo(df, p[k]), df, position[k] + i);
  }
  bool some_far_away = false;
  for (; i < points.size(); ++i) {
    const Vec3 unit = frame.to_unit(points[i]);
    const bool far = PointGroup::far_away(unit);
    some_far_away |= far;
    for (int k = 0; k < 3; ++k) position[k][i] = far ? 0.0f : static_cast<float>(unit[k]);
  }
  return some_far_away;
}

void AroundPackets(PointGroup& group, tree::FloatBox* boxes) {
  for (size_t i = 0; i < group.packets; ++i) AroundPacket(group, i, group.balls[0][i], boxes[i]);
}

}  // namespace sdm::closest::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::closest {
namespace {

HWY_EXPORT(AroundPackets);
HWY_EXPORT(MoveToFrame);

// The ball around the points of some balls, centred on their bounding box, which replaces the box of the
// first.
Ball around(std::span<const Ball> balls, std::span<tree::FloatBox> boxes, tree::FloatBox& box) {
  box = boxes[0];
  Ball ball{};
  for (int k = 0; k < 3; ++k) {
    for (const tree::FloatBox& b : boxes) {
      box.lower[k] = std::min(box.lower[k], b.lower[k]);
      box.upper[k] = std::max(box.upper[k], b.upper[k]);
    }
    ball.centre[k] = 0.5f * (box.lower[k] + box.upper[k]);
  }
  for (const Ball& b : balls) {
    float squared = 0;
    for (int k = 0; k < 3; ++k) squared += (ball.centre[k] - b.centre[k]) * (ball.centre[k] - b.centre[k]);
    ball.radius = std::max(ball.radius, std::sqrt(squared) + b.radius);
  }
  return ball;
}

}  // namespace

bool PointGroup::place(std::span<const Vec3> points, const UnitFrame& frame) {
  packets = (points.size() + kPacket - 1) / kPacket;
  const bool some_far_away = HWY_DYNAMIC_DISPATCH(MoveToFrame)(points, frame, position);
  for (auto& row : position) std::fill(row + points.size(), row + kPacket * packets, row[points.size() - 1]);
  boxes.resize(packets);
  balls[0].resize(packets);
  HWY_DYNAMIC_DISPATCH(AroundPackets)(*this, boxes.data());
  for (top = 0; balls[top].size() > 1; ++top) {
    const std::vector<Ball>& below = balls[top];
    std::vector<Ball>& here = balls[top + 1];
    here.resize((below.size() + kFan - 1) / kFan);
    for (std::size_t i = 0; i < here.size(); ++i) {
      const std::size_t first = kFan * i, count = std::min(kFan, below.size() - first);
      here[i] =
          around(std::span(below).subspan(first, count), std::span(boxes).subspan(first, count), boxes[i]);
    }
  }
  return some_far_away;
}

}  // namespace sdm::closest
#endif
