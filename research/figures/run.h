// What the figures of one run share.
#pragma once

#include <sdm/engine.h>

#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "research/figures/machine.h"
#include "research/figures/recording.h"

namespace sdm::figures {

struct Run {
  bool quick = false;
  std::filesystem::path mesh{};
  Machine machine{};
  std::shared_ptr<const Engine> gl;  ///< null without a device
  std::function<void(std::string_view)> step;

  /// The scenes of two letters and of two bunnies; simulated by the first call.
  [[nodiscard]] const Recording& letters() { return scene(letters_, scenes::SceneKind::letters); }
  [[nodiscard]] const Recording& bunnies() { return scene(bunnies_, scenes::SceneKind::bunnies); }

  /// `full`, or `less` in a quick run.
  template <class Value>
  [[nodiscard]] Value choose(Value full, Value less) const {
    return quick ? less : full;
  }

 private:
  [[nodiscard]] const Recording& scene(std::optional<Recording>& stored, scenes::SceneKind kind) {
    if (!stored) stored = record(kind, choose(150, 40), mesh, step);
    return *stored;
  }

  std::optional<Recording> letters_, bunnies_;
};

}  // namespace sdm::figures
