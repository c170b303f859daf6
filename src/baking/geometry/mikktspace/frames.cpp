#include "baking/geometry/mikktspace/frames.h"

#include <mikktspace.h>

#include <algorithm>
#include <new>

namespace sdm::baking {
namespace {

std::span<std::array<MikkCorner, 3>> triangles_of(const SMikkTSpaceContext* context) {
  return *static_cast<std::span<std::array<MikkCorner, 3>>*>(context->m_pUserData);
}

int count(const SMikkTSpaceContext* context) {
  return static_cast<int>(triangles_of(context).size());
}

int corners(const SMikkTSpaceContext* /*context*/, int /*face*/) {
  return 3;
}

void position(const SMikkTSpaceContext* context, float* out, int face, int corner) {
  std::ranges::copy(triangles_of(context)[face][corner].position, out);
}

void normal(const SMikkTSpaceContext* context, float* out, int face, int corner) {
  std::ranges::copy(triangles_of(context)[face][corner].normal, out);
}

void uv(const SMikkTSpaceContext* context, float* out, int face, int corner) {
  std::ranges::copy(triangles_of(context)[face][corner].uv, out);
}

void set(const SMikkTSpaceContext* context, const float* tangent, float sign, int face, int corner) {
  triangles_of(context)[face][corner].tangent = {tangent[0], tangent[1], tangent[2], sign};
}

}  // namespace

bool has_mikktspace() {
  return true;
}

void set_tangents(std::span<std::array<MikkCorner, 3>> triangles) {
  SMikkTSpaceInterface functions{count, corners, position, normal, uv, set, nullptr};
  SMikkTSpaceContext context{&functions, &triangles};
  // It fails for want of memory only: there is at least one triangle.
  if (!triangles.empty() && genTangSpaceDefault(&context) == 0) throw std::bad_alloc();
}

}  // namespace sdm::baking
