#include <sdm/shape.h>

#include <new>
#include <utility>

#include "bodies/shape/body.h"
#include "core/memory.h"

namespace sdm {

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
bool Shape::convex() const {
  return body_->convex() != nullptr;
}

const std::shared_ptr<shape::Body>& internals(const Shape& shape) {
  return shape.body_;
}

}  // namespace sdm
