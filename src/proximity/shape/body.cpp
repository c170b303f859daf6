#include "proximity/shape/body.h"

namespace sdm::shape {

Body::Body(const Mesh& mesh, const AtlasOptions& atlas) : surface_(mesh, atlas), sites_(mesh) {
  follow_positions();
}

void Body::refit(std::span<const Vec3> positions) {
  surface_.refit(positions);
  sites_.refit(positions);
  follow_positions();
}

void Body::require_pieces() const {
  std::call_once(pieces_->built, [this] { pieces_->value.emplace(surface_); });
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
