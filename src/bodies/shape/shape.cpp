#include <sdm/error.h>
#include <sdm/shape.h>

#include <cmath>
#include <new>
#include <string>
#include <utility>

#include "bodies/shape/body.h"
#include "core/memory.h"

namespace sdm {
namespace {

using solids::Core, solids::CoreKind;

// Sizes whose squares are far from overflow and underflow.
void check_size(double size, const char* name) {
  constexpr double kLeast = 1e-30, kMost = 1e30;
  if (!(size >= kLeast && size <= kMost))
    throw Error(std::string("the ") + name + " is not between 1e-30 and 1e30; give a finite length above 0");
}

std::shared_ptr<shape::Body> solid(const Core& core) try {
  return std::make_shared<shape::Body>(core);
} catch (const std::bad_alloc&) {
  throw out_of_memory("a shape");
}

Mesh box_mesh(const Vec3& sides) {
  Mesh mesh;
  for (unsigned corner = 0; corner < 8; ++corner)
    mesh.positions.push_back({((corner & 1) != 0 ? 0.5 : -0.5) * sides[0],
                              ((corner & 2) != 0 ? 0.5 : -0.5) * sides[1],
                              ((corner & 4) != 0 ? 0.5 : -0.5) * sides[2]});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

}  // namespace

Shape::Shape(std::shared_ptr<shape::Body> body) : body_(std::move(body)) {}

Shape Shape::sphere(double radius) {
  check_size(radius, "radius of the sphere");
  return Shape(solid({.kind = CoreKind::axis, .radius = radius}));
}
Shape Shape::capsule(double radius, double length) {
  check_size(radius, "radius of the capsule");
  check_size(length, "length of the capsule");
  return Shape(solid({.kind = CoreKind::axis, .half_length = length / 2, .radius = radius}));
}
Shape Shape::cylinder(double radius, double length) {
  check_size(radius, "radius of the cylinder");
  check_size(length, "length of the cylinder");
  return Shape(solid({.kind = CoreKind::axis, .half_length = length / 2, .disc = radius}));
}
Shape Shape::box(const Vec3& sides) {
  for (const double side : sides) check_size(side, "side of the box");
  return Shape(box_mesh(sides));
}
Shape Shape::half_space(const Vec3& normal, double offset) {
  const double length = norm(normal);
  if (!(length > 0 && std::isfinite(length)))
    throw Error("the normal of the half-space has no direction; give a finite vector other than 0");
  if (!(std::abs(offset) <= solids::kFarthest))
    throw Error("the offset of the half-space is not finite or beyond 1e37; give a smaller one");
  return Shape(solid({.kind = CoreKind::half_space, .normal = (1 / length) * normal, .offset = offset}));
}
Shape Shape::with_margin(double radius) const try {
  check_size(radius, "margin");
  const shape::Body& body = *body_;
  body.require_intact();
  if (body.has_mesh())
    return Shape(std::make_shared<shape::Body>(body.sites().mesh(), body.core().radius + radius));
  Core core = body.core();
  (core.kind == CoreKind::half_space ? core.offset : core.radius) += radius;
  return Shape(solid(core));
} catch (const std::bad_alloc&) {
  throw out_of_memory("a shape");
}

Shape::Shape(const Mesh& mesh) try : body_(std::make_shared<shape::Body>(mesh, nullptr)) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("a shape");
}
Shape::Shape(const Mesh& mesh, const AtlasOptions& atlas) try
    : body_(std::make_shared<shape::Body>(mesh, &atlas)) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("a shape");
}

Shape::Shape(StoredShape stored) try
    : body_(
          std::make_shared<shape::Body>(StoredBytes{stored.bytes, std::move(stored.owner)}, stored.trusted)) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("a shape");
}

void Shape::store(const std::function<void(std::span<const std::byte>)>& write) const try {
  body_->store(write);
} catch (const std::bad_alloc&) {
  throw out_of_memory("storing a shape");
}

bool Shape::has_surface() const {
  return body_->has_surface();
}
const Surface& Shape::surface() const {
  return body_->surface();
}
const Sites& Shape::sites() const {
  return body_->sites();
}
bool Shape::has_mesh() const {
  return body_->has_mesh();
}
double Shape::margin() const {
  return body_->core().radius;
}
bool Shape::convex() const {
  return body_->rounded() || body_->convex() != nullptr;
}

const std::shared_ptr<shape::Body>& internals(const Shape& shape) {
  return shape.body_;
}

}  // namespace sdm
