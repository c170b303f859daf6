#include "gl/rasteriser.h"

#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "atlas/size_text.h"
#include "core/memory.h"
#include "gl/device/gl_objects.h"
#include "gl/device/program.h"
#include "gl/shaders.h"
#include "gl/stencil_cache.h"

namespace sdm::gl {
namespace {

constexpr std::size_t kPiece = 1 << 16;  // polygons per piece of a batch
constexpr std::size_t kCounters = 1024;  // fragment counters, one per piece

// An upper bound on a polygon's fragments: the texels of its bounding rectangle, within the image.
double fragment_bound(std::span<const RasterCorner> corners, const ImageSize& size) {
  float lo[2] = {corners[0].u, corners[0].v}, hi[2] = {corners[0].u, corners[0].v};
  for (const RasterCorner& c : corners) {
    lo[0] = std::min(lo[0], c.u), hi[0] = std::max(hi[0], c.u);
    lo[1] = std::min(lo[1], c.v), hi[1] = std::max(hi[1], c.v);
  }
  const std::array side{static_cast<float>(size.columns), static_cast<float>(size.rows)};
  const auto extent = [&](int k) {
    return std::max(std::min(hi[k], side[k]) - std::max(lo[k], 0.0f), 0.0f) + 1.0;
  };
  return extent(0) * extent(1);
}

std::span<const RasterCorner> corners_of(const RasterBatch& batch, std::size_t polygon) {
  return {batch.corners.data() + batch.first_corner[polygon],
          batch.corners.data() + batch.first_corner[polygon + 1]};
}

template <class T>
void upload(GLuint buffer, std::span<const T> data) {
  // Allocates new storage each time: the device may still be drawing from the old one.
  glNamedBufferData(buffer, static_cast<GLsizeiptr>(data.size_bytes()), data.data(), GL_STREAM_DRAW);
}

const void* offset(std::size_t bytes) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): OpenGL takes offsets as pointers
  return reinterpret_cast<const void*>(bytes);
}

// Reads all texels of a texture, in bands of rows: OpenGL counts bytes with 31 bits.
template <class T>
void read(GLuint texture, const ImageSize& size, GLenum format, GLenum type, std::vector<T>& out) {
  out.resize(size.texels());
  const auto columns = static_cast<GLsizei>(size.columns), rows = static_cast<GLsizei>(size.rows);
  const GLsizei band = std::max(1, (1 << 30) / static_cast<GLsizei>(sizeof(T)) / columns);
  for (GLsizei row = 0; row < rows; row += band) {
    const GLsizei count = std::min(band, rows - row);
    glGetTextureSubImage(texture, 0, 0, row, 0, columns, count, 1, format, type,
                         count * columns * static_cast<GLsizei>(sizeof(T)),
                         out.data() + static_cast<std::size_t>(row) * size.columns);
  }
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

struct Rasteriser::Impl {
  const RasterDevice& device;
  ImageSize size;
  bool by_owner;
  std::optional<StencilValues> stencil;
  std::optional<StencilCache> cache;
  std::size_t piece_limit;
  std::uint64_t batches = 0, fragments = 0;
  std::size_t counters_used = 0;

  Texture<GL_TEXTURE_2D> winners, depth, owners;
  Framebuffer target;
  Buffer polygons, corners, indices, counters, stencil_texels;
  Texture<GL_TEXTURE_BUFFER> polygon_table;
  VertexArray polygon_corners, texel_points;
  std::vector<std::uint32_t> index_data;
  std::vector<std::uint32_t> order;
  Fence last;  // after the previous draw()

  Impl(const RasterDevice& d, const ImageSize& s, const Ownership& owned);

  void make_target();
  void make_inputs(const Ownership& owned);
  void clear();
  void begin();
  void end();
  void draw_piece(const RasterBatch& batch, std::size_t begin, std::size_t end);
  void draw_by_domain(const RasterBatch& batch);
  void set_stencil(std::uint32_t domain);
  void fill_stencil(std::uint32_t domain, int value);
  void begin_polygons() const;
  void collect_counters();
};

Rasteriser::Impl::Impl(const RasterDevice& d, const ImageSize& s, const Ownership& owned)
    : device(d), size(s), by_owner(std::holds_alternative<OwnerTable>(owned)) {
  if (const StencilValues* values = std::get_if<StencilValues>(&owned)) {
    stencil = *values;
    cache.emplace(values->values);
  }
  piece_limit = std::min<std::size_t>(
      kPiece, static_cast<std::size_t>(device.context().max_texture_buffer_size()) / kTexelsPerPolygon);
  make_target();
  make_inputs(owned);
  clear();
  device.context().check("preparing the map");
}

void Rasteriser::Impl::make_target() {
  check_size(device.context(), size);
  const auto columns = static_cast<GLsizei>(size.columns), rows = static_cast<GLsizei>(size.rows);
  glTextureStorage2D(winners, 1, GL_R32UI, columns, rows);
  glTextureStorage2D(depth, 1, GL_DEPTH32F_STENCIL8, columns, rows);
  glNamedFramebufferTexture(target, GL_COLOR_ATTACHMENT0, winners, 0);
  glNamedFramebufferTexture(target, GL_DEPTH_STENCIL_ATTACHMENT, depth, 0);
  device.context().check("allocating a map of " + atlas::size_text(size.columns, size.rows) + " texels");
  if (glCheckNamedFramebufferStatus(target, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(device.context().device().name +
                " cannot draw into a 32-bit depth buffer with stencil; use another device or engine");
}

void Rasteriser::Impl::make_inputs(const Ownership& owned) {
  const auto columns = static_cast<GLsizei>(size.columns), rows = static_cast<GLsizei>(size.rows);
  if (const OwnerTable* table = std::get_if<OwnerTable>(&owned)) {
    glTextureStorage2D(owners, 1, GL_R32UI, columns, rows);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})  // integers cannot be blended
      glTextureParameteri(owners, filter, GL_NEAREST);
    glTextureSubImage2D(owners, 0, 0, 0, columns, rows, GL_RED_INTEGER, GL_UNSIGNED_INT,
                        table->owners.data());
  }
  if (stencil) upload(stencil_texels, stencil->texels);

  glVertexArrayVertexBuffer(polygon_corners, 0, corners, 0, sizeof(RasterCorner));
  glVertexArrayElementBuffer(polygon_corners, indices);
  glEnableVertexArrayAttrib(polygon_corners, 0);
  glEnableVertexArrayAttrib(polygon_corners, 1);
  glVertexArrayAttribFormat(polygon_corners, 0, 2, GL_FLOAT, GL_FALSE, offsetof(RasterCorner, u));
  glVertexArrayAttribIFormat(polygon_corners, 1, 1, GL_UNSIGNED_INT, offsetof(RasterCorner, polygon));
  for (const GLuint attribute : {0u, 1u}) glVertexArrayAttribBinding(polygon_corners, attribute, 0);

  glVertexArrayVertexBuffer(texel_points, 0, stencil_texels, 0, sizeof(std::uint32_t));
  glEnableVertexArrayAttrib(texel_points, 0);
  glVertexArrayAttribIFormat(texel_points, 0, 1, GL_UNSIGNED_INT, 0);
  glVertexArrayAttribBinding(texel_points, 0, 0);

  glNamedBufferStorage(counters, kCounters * sizeof(GLuint), nullptr, 0);
}

// Sets the state that no draw changes. The context and the programs are shared with other rasterisers.
void Rasteriser::Impl::begin() {
  const auto columns = static_cast<float>(size.columns), rows = static_cast<float>(size.rows);
  const Program& program = device.programs_->polygons;
  glProgramUniform2f(program.id(), program.uniform("size"), columns, rows);
  glProgramUniform1i(program.id(), program.uniform("polygons"), 0);
  glProgramUniform1i(program.id(), program.uniform("owner"), 1);
  glProgramUniform1i(program.id(), program.uniform("by_owner"), by_owner);
  const Program& points = device.programs_->points;
  glProgramUniform2f(points.id(), points.uniform("size"), columns, rows);
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glViewport(0, 0, static_cast<GLsizei>(size.columns), static_cast<GLsizei>(size.rows));
  glDisable(GL_SCISSOR_TEST);
  stencil ? glEnable(GL_STENCIL_TEST) : glDisable(GL_STENCIL_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
}

// Submits the batch. At most two draw calls are in flight.
void Rasteriser::Impl::end() {
  const Fence before = std::exchange(last, Fence::after_all_commands());
  before.wait();
  device.context().check("drawing the polygons");
}

void Rasteriser::Impl::clear() {
  glDisable(GL_SCISSOR_TEST);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glStencilMask(0xFF);
  const std::array<GLuint, 4> nothing{kNone, 0, 0, 0};
  glClearNamedFramebufferuiv(target, GL_COLOR, 0, nothing.data());
  glClearNamedFramebufferfi(target, GL_DEPTH_STENCIL, 0, 1.0f, 0);
  const GLuint zero = 0;
  glClearNamedBufferData(counters, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &zero);
}

// Sets the state for polygons; the stencil passes use other masks.
void Rasteriser::Impl::begin_polygons() const {
  glUseProgram(device.programs_->polygons.id());
  glBindVertexArray(polygon_corners);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glStencilMask(0);
}

void Rasteriser::Impl::draw_piece(const RasterBatch& batch, std::size_t begin, std::size_t end) {
  upload(polygons, std::span(batch.polygons).subspan(begin, end - begin));
  const std::size_t first = batch.first_corner[begin];
  upload(corners, std::span(batch.corners).subspan(first, batch.first_corner[end] - first));

  order.resize(end - begin);
  std::iota(order.begin(), order.end(), static_cast<std::uint32_t>(begin));
  if (stencil) {
    const auto domain = [&](std::uint32_t polygon) { return batch.polygons[polygon].domain; };
    // Alternating order: faces still in the cache from the previous piece come first.
    if (batches % 2 == 0)
      std::ranges::stable_sort(order, std::ranges::less{}, domain);
    else
      std::ranges::stable_sort(order, std::ranges::greater{}, domain);
  }
  index_data.clear();
  for (const std::uint32_t polygon : order) {
    const auto from = static_cast<std::uint32_t>(batch.first_corner[polygon] - first);
    const auto to = static_cast<std::uint32_t>(batch.first_corner[polygon + 1] - first);
    for (std::uint32_t c = from + 1; c + 1 < to; ++c) index_data.insert(index_data.end(), {from, c, c + 1});
  }
  upload(indices, std::span<const std::uint32_t>(index_data));

  if (counters_used == kCounters) collect_counters();
  glBindBufferRange(GL_ATOMIC_COUNTER_BUFFER, 0, counters,
                    static_cast<GLintptr>(counters_used++ * sizeof(GLuint)), sizeof(GLuint));
  glTextureBuffer(polygon_table, GL_RGBA32UI, polygons);
  glBindTextureUnit(0, polygon_table);
  glBindTextureUnit(1, owners);
  const Program& program = device.programs_->polygons;
  glProgramUniform1ui(program.id(), program.uniform("first_polygon"), static_cast<GLuint>(begin));
  begin_polygons();
  if (stencil)
    draw_by_domain(batch);
  else
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(index_data.size()), GL_UNSIGNED_INT, nullptr);
  ++batches;
}

// One draw call per domain, for its consecutive polygons: its stencil value is valid for the whole call.
void Rasteriser::Impl::draw_by_domain(const RasterBatch& batch) {
  std::size_t first_index = 0;
  for (std::size_t i = 0; i < order.size();) {
    const std::uint32_t domain = batch.polygons[order[i]].domain;
    std::size_t count = 0;
    for (; i < order.size() && batch.polygons[order[i]].domain == domain; ++i)
      count += 3 * (corners_of(batch, order[i]).size() - 2);
    set_stencil(domain);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT,
                   offset(first_index * sizeof(std::uint32_t)));
    first_index += count;
  }
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

void Rasteriser::Impl::collect_counters() {
  std::array<GLuint, kCounters> counts{};
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(counters, 0, sizeof counts, counts.data());
  fragments = std::accumulate(counts.begin(), counts.end(), fragments);
  const GLuint zero = 0;
  glClearNamedBufferData(counters, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &zero);
  counters_used = 0;
}

Rasteriser::Rasteriser(const RasterDevice& device, const ImageSize& size, const Ownership& owned) {
  // The copy that is read back; on a software device, also the image and its owners.
  const std::size_t copies = device.context().device().software ? 24 : 8;
  require_memory(copies * size.texels(), "a map of " + atlas::size_text(size.columns, size.rows) + " texels");
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
  for (std::size_t begin = 0; begin < batch.size();) {
    double bound = 0;
    std::size_t end = begin;
    while (end < batch.size() && end - begin < impl_->piece_limit) {
      bound += fragment_bound(corners_of(batch, end), impl_->size);
      if (end > begin && bound > kMostFragments) break;
      ++end;
    }
    impl_->draw_piece(batch, begin, end);
    begin = end;
  }
  impl_->end();
}

RasterImage Rasteriser::read_back() {
  RasterImage image;
  read(impl_->winners, impl_->size, GL_RED_INTEGER, GL_UNSIGNED_INT, image.winners);
  read(impl_->depth, impl_->size, GL_DEPTH_COMPONENT, GL_FLOAT, image.depths);
  impl_->device.context().check("reading the map back");
  return image;
}

void Rasteriser::count_into(GlReport& report) {
  impl_->collect_counters();
  report.fragments += impl_->fragments;
  impl_->fragments = 0;
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
