// Maps of the gl engine, and the invariants of a map and its report.
#pragma once

#include <gtest/gtest.h>
#include <sdm/map.h>

#include <limits>
#include <memory>

#include "gl/raster_report.h"

namespace sdm::test {

struct GlMap : DistanceMap {
  gl::RasterReport report{};
};

/// Fails if any winner was not confirmed. All tests of maps use it, so that none can forget this check.
[[nodiscard]] GlMap gl_map(const Surface& surface, const Sites& sites, const GlOptions& options = {},
                           double max_distance = std::numeric_limits<double>::infinity());

/// The same by an engine that draws several maps.
[[nodiscard]] GlMap gl_map(const Surface& surface, const Sites& sites,
                           const std::shared_ptr<const Engine>& engine,
                           double max_distance = std::numeric_limits<double>::infinity());

/// A map for which winners may remain unconfirmed: by a faulty device.
[[nodiscard]] GlMap unconfirmed_gl_map(const Surface& surface, const Sites& sites, const GlOptions& options);

/// Whether two maps are bit-identical in every value.
[[nodiscard]] testing::AssertionResult identical(const DistanceMap& a, const DistanceMap& b);

/// Fails unless the counters obey the laws of <sdm/gl.h>, for a map without a maximum distance.
void expect_laws(const gl::RasterReport& report, const Surface& surface, const Sites& sites,
                 const GlOptions& options);

/// Fails unless the two reports have the same counts; times may differ.
void expect_same_counts(const gl::RasterReport& a, const gl::RasterReport& b);

}  // namespace sdm::test
