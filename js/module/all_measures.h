// The measures of the large module.
#pragma once

#include <sdm/measure.h>

#include <array>
#include <cstdint>
#include <functional>
#include <tuple>

#include "module/measures.h"

namespace sdm {
namespace js {

/// What the distances of a map are to.
enum class MapMeasure : std::uint8_t { sites, self, thickness };

/// The option of a map by which others are read.
struct MeasureChoice {
  MapMeasure measure = MapMeasure::sites;
};

/// Calls use(measure) with what the options ask for, of a map of this mesh.
void with_measure(const Mesh& mesh, const GivenMeasure& given,
                  const std::function<void(const Measure&)>& use);

}  // namespace js

template <>
inline constexpr std::array kWords<js::MapMeasure>{"sites", "self", "thickness"};

template <>
inline constexpr std::tuple kOptions<js::MeasureChoice>{Option{
    .name = "measure",
    .member = &js::MeasureChoice::measure,
    .text = "What is measured: the distance to the sites; self, to the rest of the same mesh, without a "
            "neighbourhood of each face; thickness, of the walls of a closed mesh. Of the last two, the "
            "sites are those of the mesh of the surface, and only the large module has them."}};

}  // namespace sdm
