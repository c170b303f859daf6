#include "proximity/shape/body.h"

#include <sdm/error.h>

#include "proximity/shape/contact_parts.h"

namespace sdm::shape {

Body::Body(const Mesh& mesh, const AtlasOptions* atlas) : sites_(mesh) {
  if (atlas) surface_.emplace(mesh, *atlas);
  follow_positions();
  contact_parts_ = shape::contact_parts(internals(sites_));
}

void Body::refit(std::span<const Vec3> positions) {
  if (surface_) surface_->refit(positions);
  sites_.refit(positions);
  follow_positions();
}

void Body::edit(const MeshEdit& edit) {
  if (surface_) surface_->edit(edit);  // may throw for want of room, the sites only for what it throws for
  sites_.edit(edit);
  inside_.reset();
  follow_positions();
  contact_parts_ = shape::contact_parts(internals(sites_));
}

const Surface& Body::surface() const {
  if (!surface_)
    throw Error(
        "there is no map of this body: its shape has no atlas; construct its Shape with AtlasOptions");
  return *surface_;
}

void Body::require_boundary() const {
  std::call_once(boundary_->built, [this] { boundary_->value.emplace(internals(sites_), inside_->sides()); });
}

void Body::follow_positions() {
  box_ = bounds(sites_.mesh());
  if (boundary_->value) boundary_ = std::make_unique<Lazy<inside::SolidBoundary>>();
  if (inside_)
    inside_->refit();
  else
    inside_.emplace(internals(sites_), solid() ? SignMethod::exact : SignMethod::none);
}

}  // namespace sdm::shape
