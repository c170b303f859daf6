#include "gl/support.h"
#include "gl/raster_report.h"

#include <algorithm>
#include <cstring>
#include <set>

namespace sdm::test {
namespace {

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

std::size_t count_sites(const Sites& sites) {
  const std::span<const Triangle> triangles = sites.mesh().triangles;
  std::set<Triangle> faces;  // each once, if its corners differ
  for (Triangle t : triangles) {
    std::ranges::sort(t);
    if (t[0] != t[1] && t[1] != t[2]) faces.insert(t);
  }
  std::set<std::uint32_t> vertices;
  for (const auto& edge : sites.edges()) vertices.insert(edge.begin(), edge.end());
  return faces.size() + sites.edges().size() + vertices.size();
}

std::size_t count_owners(const Surface& surface) {
  std::set<std::uint32_t> owners(surface.texel_faces().begin(), surface.texel_faces().end());
  owners.erase(kNone);
  return owners.size();
}

GlMap draw(const Surface& surface, const Sites& sites, const std::shared_ptr<const Engine>& engine,
           double max_distance) {
  GlMap map{compute_map(surface, sites, {.engine = engine, .max_distance = max_distance})};
  map.report = gl::raster_report(*engine).value();
  return map;
}

}  // namespace

GlMap gl_map(const Surface& surface, const Sites& sites, const GlOptions& options, double max_distance) {
  return gl_map(surface, sites, make_gl_engine(options), max_distance);
}

GlMap gl_map(const Surface& surface, const Sites& sites, const std::shared_ptr<const Engine>& engine,
             double max_distance) {
  GlMap map = draw(surface, sites, engine, max_distance);
  EXPECT_EQ(map.report.unconfirmed, 0u) << "of " << map.report.texels << " texels";
  return map;
}

GlMap unconfirmed_gl_map(const Surface& surface, const Sites& sites, const GlOptions& options) {
  return draw(surface, sites, make_gl_engine(options), std::numeric_limits<double>::infinity());
}

testing::AssertionResult identical(const DistanceMap& a, const DistanceMap& b) {
  if (a.resolution != b.resolution) return testing::AssertionFailure() << "another resolution";
  if (!same_bits(a.distance, b.distance)) return testing::AssertionFailure() << "other distances";
  if (!same_bits(a.vector, b.vector)) return testing::AssertionFailure() << "other vectors";
  if (!same_bits(a.site, b.site) || !same_bits(a.site_type, b.site_type))
    return testing::AssertionFailure() << "other sites";
  return testing::AssertionSuccess();
}

void expect_laws(const gl::RasterReport& r, const Surface& surface, const Sites& sites,
                 const GlOptions& options) {
  EXPECT_FALSE(r.device.name.empty());
  EXPECT_FALSE(r.device.driver.empty());
  EXPECT_EQ(r.clip, options.clip);

  EXPECT_EQ(r.sites, count_sites(sites));
  EXPECT_LT(r.sites_dropped, r.sites);
  EXPECT_EQ(r.faces, count_owners(surface));
  EXPECT_EQ(r.texels, surface.owned_texels());
  EXPECT_GE(r.tiles, r.faces);
  EXPECT_EQ(r.pairs, (r.sites - r.sites_dropped) * r.tiles);
  EXPECT_EQ(r.pairs, r.culled_by_bound + r.culled_by_obb + r.clipped_away + r.polygons);
  EXPECT_GE(r.polygons, r.faces) << "every face has a closest site somewhere";
  EXPECT_GE(r.fragments, r.texels) << "every texel has a closest site";
  EXPECT_GE(r.batches, 1u);
  EXPECT_LE(r.batches, r.polygons);
  EXPECT_GT(r.obb_tests, 0u);
  if (!options.bound_culling) {
    EXPECT_EQ(r.culled_by_bound, 0u);
  }

  if (options.clip == GlClip::planes) {
    EXPECT_EQ(r.stencil_lookups + r.stencil_hits + r.stencil_misses + r.stencil_evictions + r.stencil_clears,
              0u);
  } else {
    const std::uint64_t values = static_cast<std::uint64_t>(options.stencil_values);
    EXPECT_EQ(r.stencil_lookups, r.stencil_hits + r.stencil_misses);
    EXPECT_GE(r.stencil_misses, r.faces) << "every face is drawn to, and at first has no value";
    EXPECT_LE(r.stencil_lookups, r.polygons);
    EXPECT_EQ(r.stencil_misses - r.stencil_evictions, std::min(values, r.faces)) << "values in use";
    EXPECT_EQ(r.stencil_clears, r.stencil_evictions + 1);
  }

  for (const double ms : {r.time_ms.context, r.time_ms.refit, r.time_ms.bounds, r.time_ms.cull,
                          r.time_ms.draw, r.time_ms.read_back, r.time_ms.finish})
    EXPECT_GE(ms, 0);
  EXPECT_GT(r.time_ms.cull, 0);
  EXPECT_GT(r.time_ms.draw, 0);
}

void expect_same_counts(const gl::RasterReport& a, const gl::RasterReport& b) {
  EXPECT_EQ(a.sites, b.sites);
  EXPECT_EQ(a.sites_dropped, b.sites_dropped);
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_EQ(a.tiles, b.tiles);
  EXPECT_EQ(a.pairs, b.pairs);
  EXPECT_EQ(a.bound_tests, b.bound_tests);
  EXPECT_EQ(a.obb_tests, b.obb_tests);
  EXPECT_EQ(a.culled_by_bound, b.culled_by_bound);
  EXPECT_EQ(a.culled_by_obb, b.culled_by_obb);
  EXPECT_EQ(a.clipped_away, b.clipped_away);
  EXPECT_EQ(a.polygons, b.polygons);
  EXPECT_EQ(a.fragments, b.fragments);
  EXPECT_EQ(a.texels, b.texels);
  EXPECT_EQ(a.batches, b.batches);
  EXPECT_EQ(a.stencil_lookups, b.stencil_lookups);
  EXPECT_EQ(a.stencil_hits, b.stencil_hits);
  EXPECT_EQ(a.stencil_misses, b.stencil_misses);
  EXPECT_EQ(a.stencil_evictions, b.stencil_evictions);
  EXPECT_EQ(a.stencil_clears, b.stencil_clears);
}

}  // namespace sdm::test
