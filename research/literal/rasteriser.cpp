#include "research/literal/rasteriser.h"

#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <utility>

#include "atlas/size_text.h"
#include "core/memory.h"
#include "gl/device/gl_objects.h"
#include "gl/device/program.h"
#include "gl/shaders.h"
#include "gl/stencil_cache.h"
#include "research/literal/shaders.h"

namespace sdm::literal {
namespace {

using namespace gl;

constexpr std::size_t kPiece = 1 << 16;  // polygons per piece of a batch
std::span<const RasterCorner> corners_of(const PrintedBatch& batch, std::size_t polygon) {
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

struct Device::Programs {
  Program polygons{kPrintedPolygonVert, kPrintedPolygonFrag};
  Program points{gl::kTexelPointsVert, gl::kTexelPointsFrag};
  Program triangles{kFaceTriangleVert, kFaceTriangleFrag};
};

Device::Device(std::string_view wanted) : context_(wanted) {
  const Context::Current current(context_);
  programs_ = std::make_unique<Programs>();
}

Device::~Device() {
  try {
    const Context::Current current(context_);
    programs_.reset();
  } catch (const Error&) {
    programs_->polygons.forget();
    programs_->points.forget();
    programs_->triangles.forget();
  }
}

struct Rasteriser::Impl {
  const Device& device;
  ImageSize size;
  Corrections corrections;
  Stencil stencil;
  StencilCache cache;
  std::size_t piece_limit;
  std::uint64_t batches = 0;

  Texture<GL_TEXTURE_2D> winners, vectors, depth;
  Framebuffer target;
  Buffer polygons, corners, corner_vectors, indices, stencil_texels, stencil_corners;
  Texture<GL_TEXTURE_BUFFER> polygon_table;
  VertexArray polygon_corners, texel_points, face_triangles;
  std::vector<std::array<GLint, 4>> scissors;  // of each domain, if polygons extend beyond them
  std::vector<std::uint32_t> index_data;
  std::vector<std::uint32_t> order;
  Fence last;  // after the previous draw()

  Impl(const Device& d, const ImageSize& s, const Stencil& owned, const Corrections& c);

  void make_target();
  void make_inputs();
  void make_scissors();
  void clear();
  void begin();
  void end();
  void draw_piece(const PrintedBatch& batch, std::size_t begin, std::size_t end);
  void draw_by_domain(const PrintedBatch& batch);
  void set_stencil(std::uint32_t domain);
  void fill_stencil(std::uint32_t domain, int value);
  void begin_polygons() const;
};

Rasteriser::Impl::Impl(const Device& d, const ImageSize& s, const Stencil& owned, const Corrections& c)
    : device(d), size(s), corrections(c), stencil(owned), cache(owned.values.values) {
  if (!corrections.tiles) make_scissors();
  piece_limit = std::min<std::size_t>(
      kPiece, static_cast<std::size_t>(device.context().max_texture_buffer_size()) / kTexelsPerPolygon);
  make_target();
  make_inputs();
  clear();
  device.context().check("preparing the map");
}

void Rasteriser::Impl::make_target() {
  gl::Rasteriser::check_size(device.context(), size);
  const auto columns = static_cast<GLsizei>(size.columns), rows = static_cast<GLsizei>(size.rows);
  glTextureStorage2D(winners, 1, GL_R32UI, columns, rows);
  glTextureStorage2D(depth, 1, GL_DEPTH32F_STENCIL8, columns, rows);
  glNamedFramebufferTexture(target, GL_COLOR_ATTACHMENT0, winners, 0);
  if (!corrections.confirmation) {
    glTextureStorage2D(vectors, 1, GL_RGBA32F, columns, rows);
    glNamedFramebufferTexture(target, GL_COLOR_ATTACHMENT1, vectors, 0);
    const std::array<GLenum, 2> both{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    glNamedFramebufferDrawBuffers(target, 2, both.data());
  }
  glNamedFramebufferTexture(target, GL_DEPTH_STENCIL_ATTACHMENT, depth, 0);
  device.context().check("allocating a map of " + atlas::size_text(size.columns, size.rows) + " texels");
  if (glCheckNamedFramebufferStatus(target, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(device.context().device().name +
                " cannot draw into a 32-bit depth buffer with stencil; use another device or engine");
}

void Rasteriser::Impl::make_inputs() {
  upload(stencil_texels, stencil.values.texels);
  upload(stencil_corners, stencil.corners);

  glVertexArrayVertexBuffer(polygon_corners, 0, corners, 0, sizeof(RasterCorner));
  glVertexArrayElementBuffer(polygon_corners, indices);
  glEnableVertexArrayAttrib(polygon_corners, 0);
  glEnableVertexArrayAttrib(polygon_corners, 1);
  glVertexArrayAttribFormat(polygon_corners, 0, 2, GL_FLOAT, GL_FALSE, offsetof(RasterCorner, u));
  glVertexArrayAttribIFormat(polygon_corners, 1, 1, GL_UNSIGNED_INT, offsetof(RasterCorner, polygon));
  for (const GLuint attribute : {0u, 1u}) glVertexArrayAttribBinding(polygon_corners, attribute, 0);

  if (!corrections.fragment_vectors) {
    glVertexArrayVertexBuffer(polygon_corners, 1, corner_vectors, 0, sizeof(float[3]));
    glEnableVertexArrayAttrib(polygon_corners, 2);
    glVertexArrayAttribFormat(polygon_corners, 2, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(polygon_corners, 2, 1);
  }

  glVertexArrayVertexBuffer(face_triangles, 0, stencil_corners, 0, sizeof(float[2]));
  glEnableVertexArrayAttrib(face_triangles, 0);
  glVertexArrayAttribFormat(face_triangles, 0, 2, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(face_triangles, 0, 0);

  glVertexArrayVertexBuffer(texel_points, 0, stencil_texels, 0, sizeof(std::uint32_t));
  glEnableVertexArrayAttrib(texel_points, 0);
  glVertexArrayAttribIFormat(texel_points, 0, 1, GL_UNSIGNED_INT, 0);
  glVertexArrayAttribBinding(texel_points, 0, 0);
}

// The bounding rectangles of the domains, one texel larger: a rasterised triangle may differ from its texels.
void Rasteriser::Impl::make_scissors() {
  for (std::size_t d = 0; d + 1 < stencil.values.offsets.size(); ++d) {
    GLint lo[2] = {0, 0}, hi[2] = {-1, -1};
    for (std::uint32_t i = stencil.values.offsets[d]; i < stencil.values.offsets[d + 1]; ++i) {
      const std::uint32_t texel = stencil.values.texels[i];
      const GLint at[2] = {static_cast<GLint>(texel % size.columns),
                           static_cast<GLint>(texel / size.columns)};
      const bool first = i == stencil.values.offsets[d];
      for (int k = 0; k < 2; ++k) {
        lo[k] = first ? at[k] : std::min(lo[k], at[k]);
        hi[k] = first ? at[k] : std::max(hi[k], at[k]);
      }
    }
    scissors.push_back({lo[0] - 1, lo[1] - 1, hi[0] - lo[0] + 3, hi[1] - lo[1] + 3});
  }
}

// Sets the state that no draw changes. The context and the programs are shared with other rasterisers.
void Rasteriser::Impl::begin() {
  const auto columns = static_cast<float>(size.columns), rows = static_cast<float>(size.rows);
  const Program& program = device.programs_->polygons;
  glProgramUniform2f(program.id(), program.uniform("size"), columns, rows);
  glProgramUniform1i(program.id(), program.uniform("polygons"), 0);
  glProgramUniform1i(program.id(), program.uniform("interpolate"), !corrections.fragment_vectors);
  for (const Program* stencils : {&device.programs_->points, &device.programs_->triangles})
    glProgramUniform2f(stencils->id(), stencils->uniform("size"), columns, rows);
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glViewport(0, 0, static_cast<GLsizei>(size.columns), static_cast<GLsizei>(size.rows));
  glDisable(GL_SCISSOR_TEST);
  glEnable(GL_STENCIL_TEST);
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
  if (!corrections.confirmation) {
    const std::array<GLfloat, 4> zeros{};
    glClearNamedFramebufferfv(target, GL_COLOR, 1, zeros.data());
  }
  glClearNamedFramebufferfi(target, GL_DEPTH_STENCIL, 0, 1.0f, 0);
}

// Sets the state for polygons; the stencil passes use other masks.
void Rasteriser::Impl::begin_polygons() const {
  glUseProgram(device.programs_->polygons.id());
  glBindVertexArray(polygon_corners);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glStencilMask(0);
}

void Rasteriser::Impl::draw_piece(const PrintedBatch& batch, std::size_t begin, std::size_t end) {
  upload(polygons, std::span(batch.polygons).subspan(begin, end - begin));
  const std::size_t first = batch.first_corner[begin];
  upload(corners, std::span(batch.corners).subspan(first, batch.first_corner[end] - first));
  if (!corrections.fragment_vectors)
    upload(corner_vectors, std::span(batch.corner_vectors).subspan(first, batch.first_corner[end] - first));

  order.resize(end - begin);
  std::iota(order.begin(), order.end(), static_cast<std::uint32_t>(begin));
  const auto domain = [&](std::uint32_t polygon) { return batch.polygons[polygon].domain; };
  // Alternating order: faces still in the cache from the previous piece come first.
  if (batches % 2 == 0)
    std::ranges::stable_sort(order, std::ranges::less{}, domain);
  else
    std::ranges::stable_sort(order, std::ranges::greater{}, domain);
  index_data.clear();
  for (const std::uint32_t polygon : order) {
    const auto from = static_cast<std::uint32_t>(batch.first_corner[polygon] - first);
    const auto to = static_cast<std::uint32_t>(batch.first_corner[polygon + 1] - first);
    for (std::uint32_t c = from + 1; c + 1 < to; ++c) index_data.insert(index_data.end(), {from, c, c + 1});
  }
  upload(indices, std::span<const std::uint32_t>(index_data));

  glTextureBuffer(polygon_table, GL_RGBA32UI, polygons);
  glBindTextureUnit(0, polygon_table);
  const Program& program = device.programs_->polygons;
  glProgramUniform1ui(program.id(), program.uniform("first_polygon"), static_cast<GLuint>(begin));
  begin_polygons();
  draw_by_domain(batch);
  ++batches;
}

// One draw call per domain, for its consecutive polygons: its stencil value is valid for the whole call.
void Rasteriser::Impl::draw_by_domain(const PrintedBatch& batch) {
  std::size_t first_index = 0;
  for (std::size_t i = 0; i < order.size();) {
    const std::uint32_t domain = batch.polygons[order[i]].domain;
    std::size_t count = 0;
    for (; i < order.size() && batch.polygons[order[i]].domain == domain; ++i)
      count += 3 * (corners_of(batch, order[i]).size() - 2);
    set_stencil(domain);
    if (!scissors.empty()) {
      const auto& [x, y, width, height] = scissors[domain];
      glEnable(GL_SCISSOR_TEST);
      glScissor(x, y, width, height);
    }
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT,
                   offset(first_index * sizeof(std::uint32_t)));
    first_index += count;
  }
  glDisable(GL_SCISSOR_TEST);
}

// Restricts drawing to texels of the domain.
void Rasteriser::Impl::set_stencil(std::uint32_t domain) {
  const StencilCache::Use use = cache.use(domain);
  if (!use.hit) {
    const bool triangles = !stencil.corners.empty();
    glUseProgram(triangles ? device.programs_->triangles.id() : device.programs_->points.id());
    glBindVertexArray(triangles ? face_triangles : texel_points);
    glDisable(GL_SCISSOR_TEST);
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
  if (!stencil.corners.empty())
    glDrawArrays(GL_TRIANGLES, static_cast<GLint>(3 * domain), 3);
  else
    glDrawArrays(GL_POINTS, static_cast<GLint>(stencil.values.offsets[domain]),
                 static_cast<GLsizei>(stencil.values.offsets[domain + 1] - stencil.values.offsets[domain]));
}

Rasteriser::Rasteriser(const Device& device, const ImageSize& size, const Stencil& stencil,
                       const Corrections& corrections) {
  // The copy that is read back; on a software device, also the image.
  const std::size_t copies = device.context().device().software ? 24 : 8;
  require_memory((corrections.confirmation ? copies : 3 * copies) * size.texels(),
                 "a map of " + atlas::size_text(size.columns, size.rows) + " texels");
  impl_ = std::make_unique<Impl>(device, size, stencil, corrections);
}

Rasteriser::~Rasteriser() = default;

void Rasteriser::draw(const PrintedBatch& batch) {
  impl_->begin();
  for (std::size_t begin = 0; begin < batch.size(); begin += impl_->piece_limit)
    impl_->draw_piece(batch, begin, std::min(batch.size(), begin + impl_->piece_limit));
  impl_->end();
}

Image Rasteriser::read_back() {
  Image image;
  read(impl_->winners, impl_->size, GL_RED_INTEGER, GL_UNSIGNED_INT, image.winners);
  if (!impl_->corrections.confirmation) read(impl_->vectors, impl_->size, GL_RGBA, GL_FLOAT, image.vectors);
  read(impl_->depth, impl_->size, GL_DEPTH_COMPONENT, GL_FLOAT, image.depths);
  impl_->device.context().check("reading the map back");
  return image;
}

void Rasteriser::count_into(GlReport& report) const {
  const StencilCache& cache = impl_->cache;
  report.batches += impl_->batches;
  report.stencil_lookups += cache.lookups();
  report.stencil_hits += cache.hits();
  report.stencil_misses += cache.lookups() - cache.hits();
  report.stencil_evictions += cache.evictions();
  report.stencil_clears += cache.evictions() + 1;
}

}  // namespace sdm::literal
