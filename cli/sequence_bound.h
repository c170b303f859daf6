// The error bound of a body's map in each frame of `sdm sequence`.
#pragma once

#include <sdm/sampling_bound.h>

class FrameBound {
 public:
  explicit FrameBound(const sdm::Surface& first)
      : bound_(first), first_(first, bound_), built_(bound_.value()) {}

  /// After an edit of the surface, or for another one.
  void rebuild(const sdm::Surface& surface) {
    bound_ = sdm::SamplingBound(surface);
    built_ = bound_.value();
    rebuilt_ = true;
  }
  /// Parts that a tear separates are near each other when it happens: samples are then assigned to points
  /// across the tear, which the bound has to follow as these move away. So after edits, the samples are
  /// assigned again when the bound has grown, and whenever it is above `limit`, unless that is 0.
  void measure(const sdm::Surface& surface, double limit) {
    bound_.refit(surface);
    if ((rebuilt_ && value() > kGrowth * built_) || (limit > 0 && value() > limit)) rebuild(surface);
  }
  /// Whether the bound depends on which frames were measured before.
  [[nodiscard]] bool has_history() const { return rebuilt_; }

  [[nodiscard]] double value() const { return bound_.value(); }
  /// See sdm::SamplingBound.
  [[nodiscard]] double value_after(double motion) const { return bound_.value_after(motion); }
  /// See sdm::RelativeError.
  [[nodiscard]] double relative_error() const { return first_.of_edited(bound_); }

 private:
  static constexpr double kGrowth = 1.25;

  sdm::SamplingBound bound_;
  sdm::RelativeError first_;
  double built_;
  bool rebuilt_ = false;
};
