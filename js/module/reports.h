// What summaries and reports of maps take besides SummaryOptions.
#pragma once

#include <sdm/map_files.h>
#include <sdm/options.h>

#include <optional>

namespace sdm {
namespace js {

struct MapLimit {
  std::optional<double> max_distance{};
};

struct PageOptions {
  UpAxis up = UpAxis::y;
};

}  // namespace js

template <>
inline constexpr std::tuple kOptions<js::MapLimit>{max_distance_option<js::MapLimit>(
    "The maximum distance of the map; by default, that with which it was computed last.")};

template <>
inline constexpr std::tuple kOptions<js::PageOptions>{
    Option{.name = "up", .member = &js::PageOptions::up, .text = "The axis of the meshes that points up."}};

}  // namespace sdm
