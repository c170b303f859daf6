#include "research/literal/rasteriser.h"
#include "gl/raster_report.h"

#include <sdm/error.h>

#include <algorithm>
#include <array>

#include "atlas/layout.h"
#include "core/memory.h"
#include "gl/device/gl_objects.h"
#include "gl/device/program.h"
#include "gl/raster_piece.h"
#include "gl/raster_target.h"
#include "gl/shaders.h"
#include "gl/stencil_cache.h"
#include "research/literal/shaders.h"

namespace sdm::literal {

using namespace gl;

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
  Corrections corrections;
  Stencil stencil;
  StencilCache cache;
  std::uint64_t batches = 0;

  RasterTarget target;
  RasterPiece piece;
  Texture<GL_TEXTURE_2D> vectors;
  Buffer corner_vectors, stencil_texels, stencil_corners;
  VertexArray texel_points, face_triangles;
  std::vector<std::array<GLint, 4>> scissors;  // of each domain, if polygons extend beyond them

  Impl(const Device& d, const ImageSize& s, const Stencil& owned, const Corrections& c);

  void make_vectors();
  void make_inputs();
  void make_scissors();
  void begin();
  void draw_piece(const PrintedBatch& batch, std::size_t begin, std::size_t end);
  void draw_by_domain(const PrintedBatch& batch);
  void set_stencil(std::uint32_t domain);
  void fill_stencil(std::uint32_t domain, int value);
  void begin_polygons() const;
};

Rasteriser::Impl::Impl(const Device& d, const ImageSize& s, const Stencil& owned, const Corrections& c)
    : device(d), corrections(c), stencil(owned), cache(owned.values.values), target(d.context(), s) {
  if (!corrections.tiles) make_scissors();
  if (!corrections.confirmation) make_vectors();
  target.check_complete();
  make_inputs();
  target.clear();
  if (!corrections.confirmation) {
    const std::array<GLfloat, 4> zeros{};
    glClearNamedFramebufferfv(target.framebuffer(), GL_COLOR, 1, zeros.data());
  }
  device.context().check("preparing the map");
}

void Rasteriser::Impl::make_vectors() {
  const ImageSize& size = target.size();
  glTextureStorage2D(vectors, 1, GL_RGBA32F, static_cast<GLsizei>(size.columns),
                     static_cast<GLsizei>(size.rows));
  glNamedFramebufferTexture(target.framebuffer(), GL_COLOR_ATTACHMENT1, vectors, 0);
  const std::array<GLenum, 2> both{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glNamedFramebufferDrawBuffers(target.framebuffer(), 2, both.data());
}

void Rasteriser::Impl::make_inputs() {
  upload(stencil_texels, stencil.values.texels);
  upload(stencil_corners, stencil.corners);

  if (!corrections.fragment_vectors) {
    const GLuint corners = piece.vertex_array();
    glVertexArrayVertexBuffer(corners, 1, corner_vectors, 0, sizeof(float[3]));
    glEnableVertexArrayAttrib(corners, 2);
    glVertexArrayAttribFormat(corners, 2, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(corners, 2, 1);
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
  const std::uint32_t columns = target.size().columns;
  for (std::size_t d = 0; d + 1 < stencil.values.offsets.size(); ++d) {
    GLint lo[2] = {0, 0}, hi[2] = {-1, -1};
    for (std::uint32_t i = stencil.values.offsets[d]; i < stencil.values.offsets[d + 1]; ++i) {
      const std::uint32_t texel = stencil.values.texels[i];
      const GLint at[2] = {static_cast<GLint>(texel % columns), static_cast<GLint>(texel / columns)};
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
  const ImageSize& size = target.size();
  const auto columns = static_cast<float>(size.columns), rows = static_cast<float>(size.rows);
  const Program& program = device.programs_->polygons;
  glProgramUniform2f(program.id(), program.uniform("size"), columns, rows);
  glProgramUniform1i(program.id(), program.uniform("polygons"), 0);
  glProgramUniform1i(program.id(), program.uniform("interpolate"), !corrections.fragment_vectors);
  for (const Program* stencils : {&device.programs_->points, &device.programs_->triangles})
    glProgramUniform2f(stencils->id(), stencils->uniform("size"), columns, rows);
  target.begin(true);
}

// Sets the state for polygons; the stencil passes use other masks.
void Rasteriser::Impl::begin_polygons() const {
  glUseProgram(device.programs_->polygons.id());
  glBindVertexArray(piece.vertex_array());
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glStencilMask(0);
}

void Rasteriser::Impl::draw_piece(const PrintedBatch& batch, std::size_t begin, std::size_t end) {
  // Alternating order: faces still in the cache from the previous piece come first.
  piece.set(batch, begin, end,
            batches % 2 == 0 ? RasterPiece::Order::by_domain : RasterPiece::Order::by_domain_reversed,
            device.programs_->polygons);
  const std::size_t first = batch.first_corner[begin];
  if (!corrections.fragment_vectors)
    upload(corner_vectors, std::span(batch.corner_vectors).subspan(first, batch.first_corner[end] - first));
  begin_polygons();
  draw_by_domain(batch);
  ++batches;
}

void Rasteriser::Impl::draw_by_domain(const PrintedBatch& batch) {
  piece.draw_by_domain(batch, [&](std::uint32_t domain) {
    set_stencil(domain);
    if (scissors.empty()) return;
    const auto& [x, y, width, height] = scissors[domain];
    glEnable(GL_SCISSOR_TEST);
    glScissor(x, y, width, height);
  });
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
  gl::Rasteriser::check_size(device.context(), size);
  impl_ = std::make_unique<Impl>(device, size, stencil, corrections);
}

Rasteriser::~Rasteriser() = default;

void Rasteriser::draw(const PrintedBatch& batch) {
  impl_->begin();
  const std::size_t limit = RasterPiece::limit(impl_->device.context());
  for (std::size_t begin = 0; begin < batch.size(); begin += limit)
    impl_->draw_piece(batch, begin, std::min(batch.size(), begin + limit));
  impl_->target.end();
}

Image Rasteriser::read_back() {
  Image image;
  impl_->target.read(image.winners, image.depths);
  if (!impl_->corrections.confirmation)
    read_texels(impl_->vectors, impl_->target.size(), GL_RGBA, GL_FLOAT, image.vectors);
  impl_->device.context().check("reading the map back");
  return image;
}

void Rasteriser::count_into(gl::RasterReport& report) const {
  const StencilCache& cache = impl_->cache;
  report.batches += impl_->batches;
  report.stencil_lookups += cache.lookups();
  report.stencil_hits += cache.hits();
  report.stencil_misses += cache.lookups() - cache.hits();
  report.stencil_evictions += cache.evictions();
  report.stencil_clears += cache.evictions() + 1;
}

}  // namespace sdm::literal
