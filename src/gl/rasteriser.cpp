#include "gl/rasteriser.h"
#include "gl/raster_report.h"

#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "atlas/layout.h"
#include "core/memory.h"
#include "gl/device/gl_objects.h"
#include "gl/device/program.h"
#include "gl/raster_piece.h"
#include "gl/raster_target.h"
#include "gl/shaders.h"
#include "gl/stencil_cache.h"

namespace sdm::gl {
namespace {

// An upper bound on a polygon's fragments: the texels of its bounding rectangle, within the image.
double fragment_bound(std::span<const RasterCorner> corners, const ImageSize& size) {
  float lo[2] = {corners[0].u, corners[0].v}, hi[2] = {corners[0].u, corners[0].v};
  for (const RasterCorner& c : corners) {
    lo[0] = std::min(lo[0], c.u);
    hi[0] = std::max(hi[0], c.u);
    lo[1] = std::min(lo[1], c.v);
    hi[1] = std::max(hi[1], c.v);
  }
  const std::array side{static_cast<float>(size.columns), static_cast<float>(size.rows)};
  const auto extent = [&](int k) {
    return std::max(std::min(hi[k], side[k]) - std::max(lo[k], 0.0f), 0.0f) + 1.0;
  };
  return extent(0) * extent(1);
}

}  // namespace

struct RasterDevice::Programs {
  Program polygons{kSitePolygonVert, kSitePolygonFrag};
  Program points{kTexelPointsVert, kTexelPointsFrag};
};

RasterDevice::RasterDevice(std::string_view wanted) : context_(wanted) {
  const Context::Current current(context_);
  programs_ = std::make_unique<Programs>();
}

RasterDevice::~RasterDevice() {
  try {
    const Context::Current current(context_);
    programs_.reset();
  } catch (const Error&) {
    programs_->polygons.forget();
    programs_->points.forget();
  }
}

/// Atomic counters of fragments, one for each piece.
class FragmentCounters {
 public:
  FragmentCounters() {
    glNamedBufferStorage(counters_, kCounters * sizeof(GLuint), nullptr, 0);
    clear();
  }
  /// Binds the counter of the next piece. Waits for the device if all are used.
  void bind_next() {
    if (used_ == kCounters) collect();
    glBindBufferRange(GL_ATOMIC_COUNTER_BUFFER, 0, counters_, static_cast<GLintptr>(used_++ * sizeof(GLuint)),
                      sizeof(GLuint));
  }
  /// Returns the sum since the last call. Waits for the device.
  std::uint64_t take() {
    collect();
    return std::exchange(sum_, 0);
  }

 private:
  static constexpr std::size_t kCounters = 1024;

  void clear() {
    const GLuint zero = 0;
    glClearNamedBufferData(counters_, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &zero);
    used_ = 0;
  }
  void collect() {
    std::array<GLuint, kCounters> counts{};
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(counters_, 0, sizeof counts, counts.data());
    sum_ = std::accumulate(counts.begin(), counts.end(), sum_);
    clear();
  }

  Buffer counters_;
  std::size_t used_ = 0;
  std::uint64_t sum_ = 0;
};

struct Rasteriser::Impl {
  const RasterDevice& device;
  bool by_owner;
  std::optional<StencilValues> stencil;
  std::optional<StencilCache> cache;
  std::uint64_t batches = 0;

  RasterTarget target;
  RasterPiece piece;
  Texture<GL_TEXTURE_2D> owners;
  FragmentCounters counters;
  Buffer stencil_texels;
  VertexArray texel_points;

  Impl(const RasterDevice& d, const ImageSize& s, const Ownership& owned);

  void make_inputs(const Ownership& owned);
  void begin();
  void draw_piece(const RasterBatch& batch, std::size_t begin, std::size_t end);
  void set_stencil(std::uint32_t domain);
  void fill_stencil(std::uint32_t domain, int value);
  void begin_polygons() const;
};

Rasteriser::Impl::Impl(const RasterDevice& d, const ImageSize& s, const Ownership& owned)
    : device(d), by_owner(std::holds_alternative<OwnerTable>(owned)), target(d.context(), s) {
  if (const StencilValues* values = std::get_if<StencilValues>(&owned)) {
    stencil = *values;
    cache.emplace(values->values);
  }
  target.check_complete();
  make_inputs(owned);
  target.clear();
  device.context().check("preparing the map");
}

void Rasteriser::Impl::make_inputs(const Ownership& owned) {
  if (const OwnerTable* table = std::get_if<OwnerTable>(&owned)) {
    const ImageSize& size = target.size();
    const auto columns = static_cast<GLsizei>(size.columns), rows = static_cast<GLsizei>(size.rows);
    glTextureStorage2D(owners, 1, GL_R32UI, columns, rows);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})  // integers cannot be blended
      glTextureParameteri(owners, filter, GL_NEAREST);
    glTextureSubImage2D(owners, 0, 0, 0, columns, rows, GL_RED_INTEGER, GL_UNSIGNED_INT,
                        table->owners.data());
  }
  if (stencil) upload(stencil_texels, stencil->texels);

  glVertexArrayVertexBuffer(texel_points, 0, stencil_texels, 0, sizeof(std::uint32_t));
  glEnableVertexArrayAttrib(texel_points, 0);
  glVertexArrayAttribIFormat(texel_points, 0, 1, GL_UNSIGNED_INT, 0);
  glVertexArrayAttribBinding(texel_points, 0, 0);
}

// Sets the state that no draw changes. The context and the programs are shared with other rasterisers.
void Rasteriser::Impl::begin() {
  const ImageSize& size = target.size();
  const auto columns = static_cast<float>(size.columns), rows = static_cast<float>(size.rows);
  const Program& program = device.programs_->polygons;
  glProgramUniform2f(program.id(), program.uniform("size"), columns, rows);
  glProgramUniform1i(program.id(), program.uniform("polygons"), 0);
  glProgramUniform1i(program.id(), program.uniform("owner"), 1);
  glProgramUniform1i(program.id(), program.uniform("by_owner"), by_owner);
  const Program& points = device.programs_->points;
  glProgramUniform2f(points.id(), points.uniform("size"), columns, rows);
  target.begin(stencil.has_value());
}

// Sets the state for polygons; the stencil passes use other masks.
void Rasteriser::Impl::begin_polygons() const {
  glUseProgram(device.programs_->polygons.id());
  glBindVertexArray(piece.vertex_array());
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glStencilMask(0);
}

void Rasteriser::Impl::draw_piece(const RasterBatch& batch, std::size_t begin, std::size_t end) {
  // Alternating order: faces still in the cache from the previous piece come first.
  using Order = RasterPiece::Order;
  const Order order = !stencil           ? Order::as_given
                      : batches % 2 == 0 ? Order::by_domain
                                         : Order::by_domain_reversed;
  piece.set(batch, begin, end, order, device.programs_->polygons);
  counters.bind_next();
  glBindTextureUnit(1, owners);
  begin_polygons();
  if (stencil)
    piece.draw_by_domain(batch, [&](std::uint32_t domain) { set_stencil(domain); });
  else
    piece.draw();
  ++batches;
}

// Restricts drawing to texels of the domain.
void Rasteriser::Impl::set_stencil(std::uint32_t domain) {
  const StencilCache::Use use = cache->use(domain);
  if (!use.hit) {
    glUseProgram(device.programs_->points.id());
    glBindVertexArray(texel_points);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDisable(GL_DEPTH_TEST);
    glStencilMask(0xFF);
    glStencilOp(GL_REPLACE, GL_REPLACE, GL_REPLACE);
    if (use.evicted != StencilCache::kNobody) fill_stencil(use.evicted, 0);
    fill_stencil(domain, use.value);
    begin_polygons();
  }
  glStencilFunc(GL_EQUAL, use.value, 0xFF);
}

void Rasteriser::Impl::fill_stencil(std::uint32_t domain, int value) {
  glStencilFunc(GL_ALWAYS, value, 0xFF);
  glDrawArrays(GL_POINTS, static_cast<GLint>(stencil->offsets[domain]),
               static_cast<GLsizei>(stencil->offsets[domain + 1] - stencil->offsets[domain]));
}

Rasteriser::Rasteriser(const RasterDevice& device, const ImageSize& size, const Ownership& owned) {
  // The copy that is read back; on a software device, also the image and its owners.
  const std::size_t copies = device.context().device().software ? 24 : 8;
  require_memory(copies * size.texels(), "a map of " + atlas::size_text(size.columns, size.rows) + " texels");
  check_size(device.context(), size);
  impl_ = std::make_unique<Impl>(device, size, owned);
}

Rasteriser::~Rasteriser() = default;

void Rasteriser::check_size(const Context& context, const ImageSize& size) {
  const int largest = context.max_image_size();
  if (std::max(size.columns, size.rows) > static_cast<std::uint32_t>(largest))
    throw Error("a map of " + atlas::size_text(size.columns, size.rows) + " texels is too large for " +
                context.device().name + ", whose images have at most " + std::to_string(largest) +
                "²; use a lower resolution or another engine");
}

void Rasteriser::draw(const RasterBatch& batch) {
  impl_->begin();
  // A piece's fragment counter must not overflow, and its draw calls must not take so long that the driver
  // resets the device.
  constexpr double kMostFragments = 1u << 31;
  const std::size_t limit = RasterPiece::limit(impl_->device.context());
  for (std::size_t begin = 0; begin < batch.size();) {
    double bound = 0;
    std::size_t end = begin;
    while (end < batch.size() && end - begin < limit) {
      bound += fragment_bound(corners_of(batch, end), impl_->target.size());
      if (end > begin && bound > kMostFragments) break;
      ++end;
    }
    impl_->draw_piece(batch, begin, end);
    begin = end;
  }
  impl_->target.end();
}

RasterImage Rasteriser::read_back() {
  RasterImage image;
  impl_->target.read(image.winners, image.depths);
  impl_->device.context().check("reading the map back");
  return image;
}

void Rasteriser::count_into(RasterReport& report) {
  report.fragments += impl_->counters.take();
  report.batches += impl_->batches;
  if (const auto& cache = impl_->cache) {
    report.stencil_lookups += cache->lookups();
    report.stencil_hits += cache->hits();
    report.stencil_misses += cache->lookups() - cache->hits();
    report.stencil_evictions += cache->evictions();
    report.stencil_clears += cache->evictions() + 1;
  }
}

}  // namespace sdm::gl
