// One progress of a computation of several stages, each of a number of steps that is not known in advance.
#pragma once

#include <sdm/error.h>
#include <sdm/progress.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

namespace sdm::metrics {

/// Reports "metrics" with a fraction that never decreases. Each step of a stage, which begins where the
/// fraction of the step before falls or its name changes, takes half of what is left of its stage.
class StagedProgress {
 public:
  explicit StagedProgress(Progress progress) : progress_(std::move(progress)) {}
  StagedProgress(const StagedProgress&) = delete;
  StagedProgress& operator=(const StagedProgress&) = delete;

  /// Begins the stage that ends with this fraction of the whole, and returns its progress, which refers to
  /// this object; empty without a progress.
  [[nodiscard]] Progress stage(double end) {
    begin_ = end_, end_ = end, last_ = 0, step_.clear();
    if (!progress_) return {};
    return [this](std::string_view step, double fraction) { return report(step, fraction); };
  }

  void finish() const {
    if (progress_ && !progress_("metrics", 1)) throw Cancelled();
  }

 private:
  bool report(std::string_view step, double fraction) {
    if (step_ != step || fraction < last_) begin_ += share() * last_, step_ = step;
    last_ = std::clamp(fraction, 0.0, 1.0);
    return progress_("metrics", begin_ + share() * last_);
  }
  [[nodiscard]] double share() const { return (end_ - begin_) / 2; }

  Progress progress_;
  double begin_ = 0, end_ = 0;  ///< what is left of the stage
  double last_ = 0;             ///< fraction of the present step
  std::string step_;
};

}  // namespace sdm::metrics
